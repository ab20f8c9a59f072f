// SPDX-License-Identifier: Apache-2.0
#include "lut/formats/xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <memory>
#include <new>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Visit = std::function<void(const XmlElement&, const std::vector<XmlElement>&)>;

int count_lines(std::string_view text) {
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

class XmlReader {
  public:
    XmlReader(const TextLines& text, std::string_view root, const Visit& visit)
        : text_(text), all_(text.all()), root_(root), visit_(visit) {
        if (!parser_) throw std::bad_alloc();
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), call<&XmlReader::begin>, call<&XmlReader::end>);
        XML_SetStartDoctypeDeclHandler(parser_.get(), call<&XmlReader::begin_document_type>);
        XML_SetStartCdataSectionHandler(parser_.get(), call<&XmlReader::begin_section>);
    }

    void read() {
        const std::size_t nul = all_.find('\0');
        if (nul != std::string_view::npos)
            fail(nul, "the line holds bytes that are not text; expected a text file");
        const std::size_t first = all_.find_first_not_of(" \t\r\n");
        if (all_[first] != '<') fail(first, excerpt(first) + "; expected XML, which begins with <");
        // Expat copies what it is given, and keeps a tag until it ends.
        constexpr std::size_t kPiece = 1U << 16U;
        constexpr std::size_t kLongestTag = 1U << 20U;
        for (std::size_t begin = 0; begin < all_.size(); begin += kPiece) {
            const std::string_view piece = all_.substr(begin, kPiece);
            const std::size_t end = begin + piece.size();
            const XML_Status status =
                XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()),
                          end == all_.size() ? XML_TRUE : XML_FALSE);
            if (error_) std::rethrow_exception(error_);
            if (status != XML_STATUS_OK) fail_as(XML_GetErrorCode(parser_.get()));
            if (const std::size_t at = position(); end - at > kLongestTag)
                fail(at, excerpt(at) + " is longer than 1 MiB; expected a shorter tag or comment");
        }
    }

  private:
    static constexpr std::size_t kDeepest = 32;
    static constexpr std::size_t kMostAttributes = 64;

    [[noreturn]] void fail(std::size_t at, const std::string& reason) const {
        text_.fail_at(1 + count_lines(all_.substr(0, at)), reason);
    }
    [[nodiscard]] std::string excerpt(std::size_t at) const {
        return printable(first_line(all_.substr(at, 100)));
    }
    /// The begin of the last event. Expat gives -1 while it waits for the rest of a tag (2.6, and
    /// 2.5 with Debian's security updates).
    [[nodiscard]] std::size_t position() {
        const XML_Index at = XML_GetCurrentByteIndex(parser_.get());
        if (at >= 0) position_ = std::min(static_cast<std::size_t>(at), all_.size());
        return position_;
    }

    /// No exception passes through expat. It may call once more after it is stopped.
    template <auto method, class... Arguments>
    static void call(void* self, Arguments... arguments) {
        auto& reader = *static_cast<XmlReader*>(self);
        if (reader.error_) return;
        try {
            (reader.*method)(arguments...);
        } catch (...) {
            reader.error_ = std::current_exception();
            (void)XML_StopParser(reader.parser_.get(), XML_FALSE);
        }
    }

    [[noreturn]] void refuse_declaration(std::size_t at) const {
        fail(at, excerpt(at) + "; expected no document type or entities");
    }
    void begin_section() { refuse_declaration(all_.rfind("<!", position())); }
    void begin_document_type(const XML_Char*, const XML_Char*, const XML_Char*, int) {
        begin_section();
    }
    void end(const XML_Char*) {
        XmlElement element = std::move(open_.back());
        open_.pop_back();
        // The end of an empty element is where it begins.
        const std::size_t at = position();
        if (element.body.data() < all_.data() + at)
            element.body = element.body.substr(
                0, static_cast<std::size_t>(all_.data() + at - element.body.data()));
        else
            element.body = {};
        visit_(element, open_);
    }

    void begin(const XML_Char* title, const XML_Char** attributes) {
        const std::size_t at = position();
        const auto size = static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get()));
        const std::string_view tag = all_.substr(at, size);
        XmlElement element{.title = title, .name = lowercase(title)};
        element.line = static_cast<int>(XML_GetCurrentLineNumber(parser_.get()));
        if (open_.empty() && element.name != lowercase(root_))
            fail(at,
                 fmt::format("<{}> is the first element; expected {}", printable(title), root_));
        if (open_.size() == kDeepest)
            fail(at,
                 fmt::format("elements are more than {0} deep; expected at most {0}", kDeepest));
        for (; *attributes; attributes += 2) {
            std::string name = lowercase(attributes[0]);
            if (element.attribute(name))
                fail(at, fmt::format("{} stands twice; expected it once", printable(name)));
            if (element.attributes.size() == kMostAttributes)
                fail(at, fmt::format("<{}> has more than {} attributes; expected fewer",
                                     printable(title), kMostAttributes));
            element.attributes.emplace_back(std::move(name), attributes[1]);
        }
        element.body_line = element.line + count_lines(tag);
        element.body = all_.substr(at + size);  // up to the end tag, which is not read yet
        has_root_ = true;
        open_.push_back(std::move(element));
    }

    /// In our words, where expat's are of little help.
    [[noreturn]] void fail_as(XML_Error error) {
        if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
        const std::size_t at = position();
        const std::string_view rest = all_.substr(at);
        const bool is_unclosed = error == XML_ERROR_UNCLOSED_TOKEN;
        if (error == XML_ERROR_NO_ELEMENTS || (is_unclosed && !rest.starts_with('<'))) {
            fail(all_.size(), open_.empty() ? fmt::format("the file ends; expected <{}>", root_)
                                            : "the file ends; expected " + end_tag());
        }
        if (is_unclosed) fail_as_unclosed(at);
        const std::map<XML_Error, std::string> expected = {
            {XML_ERROR_JUNK_AFTER_DOC_ELEMENT, "nothing after the document"},
            {XML_ERROR_MISPLACED_XML_PI, "it at the beginning of the file"},
            {XML_ERROR_UNDEFINED_ENTITY, "no document type or entities"},
            {XML_ERROR_SYNTAX, fmt::format("<{}>", root_)},
        };
        if (const auto found = expected.find(error); found != expected.end())
            fail(at, excerpt(at) + "; expected " + found->second);
        const std::size_t open = all_.rfind('<', at > 0 ? at - 1 : 0);
        if (open != std::string_view::npos) fail_in_markup(error, at, open);
        fail(at, fmt::format("{}; expected XML ({})", excerpt(at), XML_ErrorString(error)));
    }
    [[noreturn]] void fail_as_unclosed(std::size_t at) const {
        const std::string_view markup = all_.substr(at);
        if (markup.starts_with("<!--")) fail(at, "the comment does not close; expected -->");
        if (markup.starts_with("<?")) fail(at, "the instruction does not close; expected ?>");
        fail(at, "the tag does not close; expected >");
    }
    /// @param open  the last < before the position of the error
    void fail_in_markup(XML_Error error, std::size_t at, std::size_t open) const {
        const std::string_view markup = all_.substr(open);
        const std::string_view tag =
            markup.substr(0, std::min(markup.find('>'), markup.size() - 1) + 1);
        const std::string shown = printable(first_line(tag));
        if (tag.starts_with("</") && (error == XML_ERROR_TAG_MISMATCH || open_.empty())) {
            fail(open, fmt::format("{} closes no element; expected {}", shown,
                                   !open_.empty() ? end_tag()
                                   : has_root_    ? "nothing after the document"
                                                  : fmt::format("<{}>", root_)));
        }
        if (error != XML_ERROR_INVALID_TOKEN || markup.starts_with("<!--"))
            fail(open, fmt::format("{}; expected XML ({})", shown, XML_ErrorString(error)));
        if (at - open >= tag.size()) {  // text
            const std::size_t reference = all_.rfind('&', at);
            const bool is_reference = reference != std::string_view::npos && reference > open;
            fail(at, excerpt(is_reference ? reference : at) +
                         "; expected UTF-8 with &amp; for & and &lt; for <");
        }
        if (markup.starts_with("<!")) refuse_declaration(open);
        if (markup.starts_with("<?") || all_[at] == '<') fail_as_unclosed(open);
        const bool has_attributes = tag.substr(0, at - open).find_first_of(" \t\r\n") != tag.npos;
        fail(open, shown + (has_attributes ? "; expected attributes such as dim=\"...\""
                                           : "; expected a tag such as <Array dim=\"...\">"));
    }
    [[nodiscard]] std::string end_tag() const { return "</" + printable(open_.back().title) + ">"; }

    std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_{XML_ParserCreate(nullptr),
                                                                         XML_ParserFree};
    const TextLines& text_;
    std::string_view all_;
    std::string_view root_;
    const Visit& visit_;
    std::vector<XmlElement> open_;
    std::size_t position_ = 0;
    bool has_root_ = false;
    std::exception_ptr error_;
};

}  // namespace

std::optional<std::string> XmlElement::attribute(std::string_view which) const {
    for (const auto& [own, value] : attributes) {
        if (own == which) return value;
    }
    return std::nullopt;
}

void visit_xml(const TextLines& text, std::string_view root, const Visit& visit) {
    XmlReader(text, root, visit).read();
}

TONEWRIGHT_NAMESPACE_END
