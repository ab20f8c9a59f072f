// SPDX-License-Identifier: Apache-2.0
#include "report/sha256.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The first 32 bits of the fractional part of `root` of the first primes.
template <std::size_t N, class Root>
std::array<std::uint32_t, N> fractions_of_primes(const Root& root) {
    std::array<std::uint32_t, N> result{};
    int prime = 2;
    for (std::uint32_t& bits : result) {
        const long double value = root(static_cast<long double>(prime));
        bits = static_cast<std::uint32_t>((value - std::floor(value)) * 0x1p32L);
        const auto is_prime = [](int n) {
            for (int k = 2; k * k <= n; ++k) {
                if (n % k == 0) return false;
            }
            return true;
        };
        do
            ++prime;
        while (!is_prime(prime));
    }
    return result;
}

}  // namespace

std::string sha256(std::string_view bytes) {
    static const auto round_constants =
        fractions_of_primes<64>([](long double x) { return std::cbrt(x); });
    auto state = fractions_of_primes<8>([](long double x) { return std::sqrt(x); });

    std::string message(bytes);
    message += '\x80';
    while (message.size() % 64 != 56)
        message += '\0';
    const std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
    for (int shift = 56; shift >= 0; shift -= 8)
        message += static_cast<char>(bits >> static_cast<unsigned>(shift) & 0xFFU);

    for (std::size_t block = 0; block < message.size(); block += 64) {
        std::array<std::uint32_t, 64> w{};
        for (std::size_t i = 0; i < 64; ++i)
            w[i / 4] = w[i / 4] << 8U | static_cast<unsigned char>(message[block + i]);
        for (std::size_t i = 16; i < 64; ++i) {
            const std::uint32_t a = w[i - 15];
            const std::uint32_t b = w[i - 2];
            w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3U) + w[i - 7] +
                   (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10U);
        }
        auto [a, b, c, d, e, f, g, h] = state;
        for (std::size_t i = 0; i < 64; ++i) {
            const std::uint32_t t1 = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                     ((e & f) ^ (~e & g)) + round_constants[i] + w[i];
            const std::uint32_t t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) +
                                     ((a & b) ^ (a & c) ^ (b & c));
            h = g;
            g = f;
            f = e;
            e = d + t1;
            d = c;
            c = b;
            b = a;
            a = t1 + t2;
        }
        const std::array<std::uint32_t, 8> sum = {a, b, c, d, e, f, g, h};
        for (std::size_t i = 0; i < 8; ++i)
            state[i] += sum[i];
    }
    std::string digest;
    for (const std::uint32_t word : state) {
        for (int shift = 24; shift >= 0; shift -= 8)
            digest += static_cast<char>(word >> static_cast<unsigned>(shift) & 0xFFU);
    }
    return digest;
}

TONEWRIGHT_NAMESPACE_END
