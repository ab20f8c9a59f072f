// SPDX-License-Identifier: Apache-2.0
#include "image/spec_conversion.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN

PictureSpec picture_spec(const OIIO::ImageSpec& spec) {
    PictureSpec result;
    copy_structure(spec, result);
    result.attributes.reserve(spec.extra_attribs.size());
    for (const OIIO::ParamValue& value : spec.extra_attribs) {
        PictureAttribute attribute = {value.name().string(), value.type(), {}, {}};
        if (value.type().basetype == OIIO::TypeDesc::STRING) {
            const auto* const texts = static_cast<const OIIO::ustring*>(value.data());
            const std::size_t count =
                value.type().basevalues() * static_cast<std::size_t>(value.nvalues());
            for (std::size_t i = 0; i < count; ++i)
                attribute.texts.push_back(texts[i].string());
        } else {
            const auto* const bytes = static_cast<const std::byte*>(value.data());
            attribute.data.assign(bytes, bytes + value.datasize());
        }
        result.attributes.push_back(std::move(attribute));
    }
    return result;
}

OIIO::ImageSpec image_spec(const PictureSpec& spec) {
    OIIO::ImageSpec result;
    copy_structure(spec, result);
    result.extra_attribs.reserve(spec.attributes.size());
    for (const PictureAttribute& attribute : spec.attributes) {
        const std::vector<OIIO::ustring> texts(attribute.texts.begin(), attribute.texts.end());
        const bool is_text = attribute.type.basetype == OIIO::TypeDesc::STRING;
        const std::size_t each = is_text ? attribute.type.basevalues() : attribute.type.size();
        const std::size_t all = is_text ? texts.size() : attribute.data.size();
        result.extra_attribs.emplace_back(
            OIIO::ustring(attribute.name), attribute.type,
            static_cast<int>(each > 0 ? all / each : 1),
            is_text ? static_cast<const void*>(texts.data()) : attribute.data.data());
    }
    return result;
}

void erase_attribute(OIIO::ImageSpec& spec, std::string_view name) {
    auto& all = spec.extra_attribs;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const OIIO::ParamValue& attribute) {
                                 return is_equal_but_for_case(attribute.name().string(), name);
                             }),
              all.end());
}

TONEWRIGHT_NAMESPACE_END
