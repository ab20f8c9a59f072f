// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct XmlElement {
    std::string title;
    /// The title in lower case: OpenColorIO ignores case in most formats.
    std::string name = {};
    /// With names in lower case.
    std::vector<std::pair<std::string, std::string>> attributes = {};
    int line = 1;
    /// Everything between the element's tags, as the file has it.
    std::string_view body = {};
    /// The first line of the body.
    int body_line = 1;

    [[nodiscard]] std::optional<std::string> attribute(std::string_view which) const;
};

/// Reads a file with expat, as OpenColorIO does. Refuses document types (so that no entity can be
/// declared), CDATA sections, more than 32 open elements, and tags and comments of more than 1 MiB
/// or 64 attributes. Needs 1 MiB of memory.
/// @param root   name of the outermost element, in any case
/// @param visit  receives each element when it ends, and the elements around it, without their
/// bodies
/// @throws FileError  with path, line and reason.
void visit_xml(const TextLines& text, std::string_view root,
               const std::function<void(const XmlElement& element,
                                        const std::vector<XmlElement>& around)>& visit);

TONEWRIGHT_NAMESPACE_END
