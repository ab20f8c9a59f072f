// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "lut/fit.h"
#include "lut/half_domain.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kDefaultCubeSize = 33;
constexpr int kDefaultCurveSize = 4096;

/// Table input -> result of the view.
Pipeline table_pipeline(const LutRequest& request) {
    Pipeline stages = {curve_stage(request.encoding.decode)};
    const Pipeline view = build_view(request.view);
    stages.insert(stages.end(), view.begin(), view.end());
    return stages;
}

struct FormatTraits {
    const char* name;
    bool has_1d;
    bool has_3d;
    int default_size;  // of a 3D LUT
    int smallest;
    int largest;
    std::array<int, 3> bits;  // the first is the default; 0: none
};

/// In the order of LutFormat.
constexpr std::array<FormatTraits, 15> kFormats = {{
    {"cube", true, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"clf", true, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"ctf", true, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"spi1d", true, false, 0, 0, 0, {32, 0, 0}},
    {"spi3d", false, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"csp", false, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"resolve_cube", false, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    // Autodesk's readers know 17, 33 and 65.
    {"3dl", false, true, kDefaultCubeSize, 17, 65, {12, 10, 16}},
    {"lut", false, true, kDefaultCubeSize, 17, 129, {32, 0, 0}},
    {"icc", false, true, kDefaultCubeSize, 17, 129, {16, 0, 0}},
    // Level 8.
    {"hald", false, true, 64, 16, 144, {16, 8, 32}},
    {"strip", false, true, 32, 2, 64, {16, 8, 32}},
    {"strip_up", false, true, 32, 2, 64, {16, 8, 32}},
    {"raw", false, true, kDefaultCubeSize, 2, 129, {32, 0, 0}},
    {"ktx2", false, true, kDefaultCubeSize, 2, 129, {32, 0, 0}},
}};

const FormatTraits& traits_of(LutFormat format) {
    return kFormats[static_cast<std::size_t>(format)];
}

bool is_square(int n) {
    const int root = static_cast<int>(std::lround(std::sqrt(n)));
    return root * root == n;
}

int bits_of(const LutRequest& request) {
    return request.bits.value_or(traits_of(request.format).bits.front());
}

void check_bits(const LutRequest& request, const FormatTraits& traits) {
    std::vector<std::string> known;
    for (const int bits : traits.bits) {
        if (bits == 0) continue;
        if (bits == bits_of(request)) return;
        known.push_back(std::to_string(bits));
    }
    throw Error({.parameter = "depth",
                 .value = std::to_string(bits_of(request)),
                 .expected = join_choices(known) + " for " + traits.name});
}

[[noreturn]] void refuse_size(int size, const std::string& expected) {
    throw Error({.parameter = "size", .value = std::to_string(size), .expected = expected});
}

int checked_size(const LutRequest& request, int fallback, int lo, int hi) {
    const int size = request.size.value_or(fallback);
    if (size < lo || size > hi)
        refuse_size(size, "[" + std::to_string(lo) + ", " + std::to_string(hi) + "]");
    return size;
}

/// One table per channel: the three curves may differ (a look's slope).
Lut sample_half_curve(const LutRequest& request) {
    Lut lut;
    lut.dimension = 1;
    lut.size = static_cast<int>(kHalfCount);
    lut.channels = 1;
    lut.is_half_domain = true;
    // A view clamps its own input; the table is constant outside that range.
    lut.values = sample_half_domain(compose(build_view(request.view))[0], -kHalfMax, kHalfMax);
    return lut;
}

}  // namespace

Lut sample_lut(const LutRequest& request) {
    const bool per_channel = is_per_channel(build_view(request.view));
    const FormatTraits& traits = traits_of(request.format);
    if (request.dimension == LutDimension::three && !traits.has_3d) {
        throw Error({.parameter = "format",
                     .value = traits.name,
                     .expected = "a 3D format (cube, clf, ctf, spi3d, csp, resolve_cube, 3dl, lut, "
                                 "icc, hald, strip, strip_up, raw) with <<dimension=3d>>"});
    }
    if (request.dimension == LutDimension::one && !traits.has_1d) {
        throw Error({.parameter = "format",
                     .value = traits.name,
                     .expected = "a 1D format (cube, clf, ctf, spi1d) with <<dimension=1d>>"});
    }
    const bool one =
        traits.has_1d && (!traits.has_3d || request.dimension == LutDimension::one ||
                          (request.dimension == LutDimension::automatic && per_channel));
    check_bits(request, traits);
    if (request.decimals && request.format != LutFormat::cube) {
        throw Error(
            {.parameter = "decimals",
             .value = std::to_string(*request.decimals),
             .expected = std::string("none for ") + traits.name + "; only cube has decimals"});
    }
    if (request.decimals && (*request.decimals < 3 || *request.decimals > 9)) {
        throw Error({.parameter = "decimals",
                     .value = std::to_string(*request.decimals),
                     .expected = "[3, 9]"});
    }
    // Readers support at most 65536 equal scene-linear steps, which are short enough up to
    // ACEScct's 222.9.
    constexpr double kBrightestShaper = 223;
    if (has_shaper(request.format) && request.encoding.scene_hi > kBrightestShaper) {
        throw Error(
            {.parameter = "input_encoding",
             .value = request.encoding.id + ", up to " + shortest(request.encoding.scene_hi),
             .expected = std::string("up to 223 for ") + traits.name});
    }
    if (one && !per_channel) {
        throw Error(Problem{.value = request.view.op.label + " mixes channels (or " +
                                     request.view.input + " is not its own space)",
                            .expected = "a 3D table"});
    }
    if (!one && request.encoding.is_linear) {
        throw Error({.parameter = "input_encoding",
                     .value = request.encoding.id,
                     .expected =
                         "another for a 3D table, such as acescct or log2 (a 3D LUT of linear "
                         "input clips at its end and bands in the shadows)"});
    }
    const bool has_half_domain =
        request.format == LutFormat::clf || request.format == LutFormat::ctf;
    if (one && has_half_domain && request.encoding.is_linear) {
        if (request.size)
            refuse_size(*request.size,
                        "none, a half-domain " + std::string(traits.name) + " has 65536 entries");
        return sample_half_curve(request);
    }

    Lut lut;
    lut.dimension = one ? 1 : 3;
    lut.channels = one ? 1 : 3;
    const int grid = request.encoding.grid_size;
    const bool takes_grid =
        traits.default_size == kDefaultCubeSize && grid > 0 && request.format != LutFormat::threedl;
    lut.size = one ? checked_size(request, kDefaultCurveSize, 2, static_cast<int>(kHalfCount))
                   : checked_size(request, takes_grid ? grid : traits.default_size, traits.smallest,
                                  traits.largest);
    if (!one && request.format == LutFormat::threedl && lut.size != 17 && lut.size != 33 &&
        lut.size != 65)
        refuse_size(lut.size, "17, 33 or 65 for 3dl");
    if (request.format == LutFormat::hald && !is_square(lut.size)) {
        refuse_size(lut.size, "a square for a Hald CLUT: 16, 25, 36, 49, 64, 81, 100, 121 or 144");
    }
    const auto n = static_cast<std::size_t>(lut.size);
    std::vector<double> axis(n);
    for (std::size_t i = 0; i < n; ++i)
        axis[i] = static_cast<double>(i) / static_cast<double>(n - 1);

    const ReferenceEngine engine(table_pipeline(request));
    const std::size_t count = one ? n : n * n * n;
    std::array<std::vector<double>, 3> plane;
    for (auto& p : plane)
        p.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        plane[0][i] = axis[one ? i : i % n];
        plane[1][i] = axis[one ? i : i / n % n];
        plane[2][i] = axis[one ? i : i / (n * n)];
    }
    const std::array<double*, 3> out = {plane[0].data(), plane[1].data(), plane[2].data()};
    engine.run({out[0], out[1], out[2]}, out, count);
    lut.values.reserve(count * static_cast<std::size_t>(lut.channels));
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < static_cast<std::size_t>(lut.channels); ++c) {
            lut.values.push_back(static_cast<float>(plane[c][i]));
        }
    }
    return lut;
}

Lut fit_lut(const LutRequest& request, const Lut& sampled, double photograph_share,
            const std::function<void(Lut&)>& constrain) {
    if (sampled.dimension != 3)
        throw Error(Problem{.value = "a 1D table has no grid to fit", .expected = "a 3D LUT"});
    CubeProblem problem;
    problem.edge = sampled.size;
    problem.axis = {request.encoding.encode, request.encoding.decode, request.encoding.scene_hi};
    problem.pipeline = build_view(request.view);
    problem.primaries = find_input_space(request.view.input).primaries;
    // Clamp the table to the range of the view.
    const auto [lowest, highest] =
        std::minmax_element(sampled.values.begin(), sampled.values.end());
    problem.lo = static_cast<double>(*lowest);
    problem.hi = static_cast<double>(*highest);
    const auto n = static_cast<std::size_t>(sampled.size);
    // The entry of a cube, blue fastest, that is entry i of a LUT, red fastest.
    const auto in_cube = [&](std::size_t i) { return (i % n * n + i / n % n) * n + i / (n * n); };
    Lut lut = sampled;
    const auto take = [&](const std::vector<double>& nodes) {
        for (std::size_t i = 0; i < n * n * n; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                lut.values[3 * i + c] = static_cast<float>(
                    std::clamp(nodes[3 * in_cube(i) + c], problem.lo, problem.hi));
            }
        }
    };
    CubeFitOptions options{.photograph_share = photograph_share, .constrain = {}};
    if (constrain) {
        options.constrain = [&](std::vector<double>& nodes) {
            take(nodes);
            constrain(lut);
            for (std::size_t i = 0; i < n * n * n; ++i) {
                for (std::size_t c = 0; c < 3; ++c)
                    nodes[3 * in_cube(i) + c] = static_cast<double>(lut.values[3 * i + c]);
            }
        };
    }
    take(fit_cube(problem, options));
    return lut;
}

void quantize(Lut& lut, const LutRequest& request) {
    if (request.decimals) {
        lut.decimals = request.decimals;
        const double unit = std::pow(10.0, *request.decimals);
        for (float& v : lut.values)
            v = static_cast<float>(std::round(static_cast<double>(v) * unit) / unit);
    }
    const int bits = bits_of(request);
    if (bits == 32) return;
    const float largest = std::exp2(static_cast<float>(bits)) - 1;
    for (float& v : lut.values)
        v = std::round(std::clamp(v, 0.0F, 1.0F) * largest) / largest;
}

TONEWRIGHT_NAMESPACE_END
