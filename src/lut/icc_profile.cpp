// SPDX-License-Identifier: Apache-2.0
#include "lut/icc_profile.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

IccTags::IccTags(std::string_view bytes, const RefuseIcc& refuse) : bytes_(bytes), refuse_(refuse) {
    if (bytes.size() < kIccHeader + 4 || bytes.substr(36, 4) != "acsp")
        refuse("expected an ICC profile");
    if (big_endian(bytes, 0, 4) > bytes.size()) {
        refuse(fmt::format("declares {} bytes; the file has {}", big_endian(bytes, 0, 4),
                           bytes.size()));
    }
    const std::uint32_t tags = big_endian(bytes, kIccHeader, 4);
    for (std::size_t i = 0; i < tags; ++i) {
        const std::size_t entry = kIccHeader + 4 + 12 * i;
        if (entry + 12 > bytes.size()) refuse("the table of tags is longer than the file");
        entries_.push_back(entry);
    }
}

std::size_t IccTags::count(std::string_view name) const {
    return static_cast<std::size_t>(
        std::count_if(entries_.begin(), entries_.end(),
                      [&](std::size_t entry) { return bytes_.substr(entry, 4) == name; }));
}

std::string_view IccTags::find(std::string_view name) const {
    for (const std::size_t entry : entries_) {
        if (bytes_.substr(entry, 4) != name) continue;
        const std::size_t begin = big_endian(bytes_, entry + 4, 4);
        const std::size_t length = big_endian(bytes_, entry + 8, 4);
        if (begin > bytes_.size() || length > bytes_.size() - begin)
            refuse_(fmt::format("tag {} is longer than the file", name));
        if (length < 8) refuse_(fmt::format("tag {} has {} bytes; expected 8", name, length));
        return bytes_.substr(begin, length);
    }
    return {};
}

std::vector<std::size_t> check_icc_table(std::string_view name, std::string_view tag,
                                         std::size_t channels_in, const RefuseIcc& refuse) {
    if (tag.size() < 48) refuse(fmt::format("there is no tag {}", name));
    const std::string_view type = tag.substr(0, 4);
    if (type != "mft1" && type != "mft2" && type != "mAB ") {
        refuse(
            fmt::format("{} is of type \"{}\"; expected mft1, mft2 or mAB", name, printable(type)));
    }
    if (big_endian(tag, 8, 1) != channels_in || tag[9] != 3)
        refuse(fmt::format("{} has {} channels in and {} out; expected {} and 3", name,
                           big_endian(tag, 8, 1), big_endian(tag, 9, 1), channels_in));
    std::vector<std::size_t> grid(channels_in, 2);
    std::size_t width = 2;  // of a number
    if (type != "mAB ") {
        std::fill(grid.begin(), grid.end(), big_endian(tag, 10, 1));
        width = type == "mft1" ? 1 : 2;
    } else if (const std::size_t at = big_endian(tag, 24, 4); at != 0) {
        if (at > tag.size() || tag.size() - at < 20)
            refuse(fmt::format("{} is longer than the file", name));
        for (std::size_t i = 0; i < channels_in; ++i)
            grid[i] = big_endian(tag, at + i, 1);
        width = big_endian(tag, at + 16, 1);
    }
    std::size_t nodes = 1;
    for (const std::size_t side : grid)
        nodes *= side;
    if (*std::min_element(grid.begin(), grid.end()) < 2 || nodes * 3 * width > tag.size()) {
        refuse(fmt::format("{} declares {} nodes in {} bytes; expected 2 or more a side, with room",
                           name, fmt::join(grid, " x "), tag.size()));
    }
    return grid;
}

void check_icc_elements(std::string_view name, std::string_view tag, const RefuseIcc& refuse) {
    const auto require = [&](bool is_there) {
        if (!is_there) refuse(fmt::format("{} is longer than the file", name));
    };
    require(tag.size() >= 16);
    if (tag.substr(0, 4) != "mpet")
        refuse(
            fmt::format("{} is of type \"{}\"; expected mpet", name, printable(tag.substr(0, 4))));
    const std::size_t elements = big_endian(tag, 12, 4);
    for (std::size_t i = 0; i < elements; ++i) {
        require(16 + 8 * (i + 1) <= tag.size());
        const std::size_t at = big_endian(tag, 16 + 8 * i, 4);
        require(at <= tag.size() && tag.size() - at >= 12);
        if (tag.substr(at, 4) != "clut") continue;
        const std::size_t in = big_endian(tag, at + 8, 2);
        const std::size_t out = big_endian(tag, at + 10, 2);
        if (in < 1 || in > 16 || out < 1 || out > 16)
            refuse(fmt::format("{} has a table of {} channels; expected 1 to 16", name,
                               std::max(in, out)));
        require(tag.size() - at >= 28);
        std::size_t numbers = out;
        for (std::size_t c = 0; c < in; ++c) {
            numbers *= big_endian(tag, at + 12 + c, 1);
            require(numbers <= tag.size() / 4);
        }
    }
}

TONEWRIGHT_NAMESPACE_END
