// SPDX-License-Identifier: Apache-2.0
#include "ocio/read_config.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_file.h"
#include "base/strings.h"
#include "ocio/references.h"
#include "tonewright/error.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// OpenColorIO compares each name with all others when it loads a config: seconds for thousands,
/// minutes for tens of thousands. The largest configs that studios share have several hundred.
constexpr std::size_t kMostSpaces = 4000;
constexpr std::size_t kMostViews = 4000;
constexpr std::size_t kMostBytes = std::size_t{64} << 20;

std::size_t count_of(std::string_view text, std::string_view word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string_view::npos;
         at = text.find(word, at + word.size()))
        ++count;
    return count;
}

/// Counts the nodes of a text as OpenColorIO reads them, with a copy for each alias. In a few
/// lines, aliases of aliases make billions; an alias inside its own node would never end.
class AliasCount final : public YAML::EventHandler {
  public:
    explicit AliasCount(const std::string& path) : path_(path) {}

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark&, YAML::anchor_t anchor) override { add(anchor); }
    void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                  const std::string&) override {
        add(anchor);
    }
    void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open_.emplace_back(anchor, count_++);
    }
    void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open_.emplace_back(anchor, count_++);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapEnd() override { close(); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto node = sizes_.find(anchor);
        if (node == sizes_.end()) {
            throw FileError(
                fmt::format("read: {}:{}: the alias is inside its own node", path_, mark.line + 1));
        }
        count_ += node->second;
        if (count_ <= kMostNodes) return;
        throw FileError(fmt::format("read: {}:{}: aliases make more than {} nodes", path_,
                                    mark.line + 1, kMostNodes));
    }

  private:
    /// OpenColorIO 2.1 takes 1.4 s and 150 MB for 1.3 million.
    static constexpr std::size_t kMostNodes = 1'000'000;

    void add(YAML::anchor_t anchor) {
        ++count_;
        if (anchor != 0) sizes_[anchor] = 1;
    }
    void close() {
        const auto [anchor, begin] = open_.back();
        open_.pop_back();
        if (anchor != 0) sizes_[anchor] = count_ - begin;
    }

    const std::string& path_;
    std::size_t count_ = 0;
    std::map<YAML::anchor_t, std::size_t> sizes_;  // of nodes that have ended
    std::vector<std::pair<YAML::anchor_t, std::size_t>> open_;
};

/// @throws FileError
void check_aliases(const std::string& path, const std::string& yaml) {
    if (yaml.find('&') == std::string::npos || yaml.find('*') == std::string::npos) return;
    std::istringstream text(yaml);
    AliasCount count(path);
    try {
        YAML::Parser(text).HandleNextDocument(count);
    } catch (const YAML::Exception&) {
        return;  // OpenColorIO reports it
    }
}

void check_size(const std::string& path, const std::string& yaml) {
    const auto limit = [&](std::string_view tag, const char* what, std::size_t most) {
        const std::size_t count = count_of(yaml, tag);
        if (count > most) {
            throw FileError(
                fmt::format("read: {}: has {} {}; expected at most {}", path, count, what, most));
        }
    };
    limit("!<ColorSpace>", "color spaces", kMostSpaces);
    limit("!<View>", "views", kMostViews);
    check_aliases(path, yaml);
}

/// @param load  makes OpenColorIO's config
template <class Load>
OCIO::ConfigRcPtr checked(const std::string& path, const Load& load) {
    try {
        OCIO::ConfigRcPtr config = editable_copy(*load());
        config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
        check_references(*config, path);
        return config;
    } catch (const OCIO::Exception& e) {
        throw FileError("read: " + path + ": " + one_line(e.what()));
    }
}

}  // namespace

OCIO::ConfigRcPtr editable_copy(const OCIO::Config& config) {
    OCIO::ConfigRcPtr copy = config.createEditableCopy();
    copy->setDefaultViewTransformName(config.getDefaultViewTransformName());
    return copy;
}

std::string read_config_text(const std::string& path) {
    return read_file(path, kMostBytes,
                     [&](const Problem& why) { throw FileError(within("read: " + path, why)); });
}

OCIO::ConfigRcPtr read_config(const std::string& path) {
    const std::string text = read_config_text(path);
    const bool is_archive = text.starts_with("PK");  // .ocioz: OpenColorIO 2.2 and newer open it
    if (!is_archive) return read_config(path, text);
    return checked(path, [&] { return OCIO::Config::CreateFromFile(path.c_str()); });
}

OCIO::ConfigRcPtr read_config(const std::string& path, const std::string& text) {
    check_size(path, text);
    return checked(path, [&] {
        std::istringstream stream(text);
        OCIO::ConfigRcPtr config = editable_copy(*OCIO::Config::CreateFromStream(stream));
        config->setWorkingDir(std::filesystem::absolute(path).parent_path().c_str());
        return config;
    });
}

AnyConfig read_any_config(const std::string& path, const std::string& text) {
    check_size(path, text);
    if (std::optional<ReadableProfile> newer = make_readable(text)) {
        OCIO::ConfigRcPtr config = read_config(path, newer->text);
        return {std::move(config), std::move(newer)};
    }
    return {read_config(path, text)};
}

void redirect_opencolorio_messages(const std::function<void(const std::string&)>& print) {
    const auto already_warned = std::make_shared<std::set<std::string>>();
    const auto lock = std::make_shared<std::mutex>();
    OCIO::SetLoggingFunction([=](const char* text) {
        // "[OpenColorIO Warning]: ..."
        std::string message = one_line(text);
        if (message.starts_with('[')) {
            const std::size_t end = message.find("]: ");
            if (end != std::string::npos) message.erase(0, end + 3);
        }
        const std::scoped_lock guard(*lock);
        if (!message.empty() && already_warned->insert(message).second) print(message);
    });
}

TONEWRIGHT_NAMESPACE_END
