// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: configs of any bytes, of `verify --config` and `config --into`, and the record of what
// `--into` has added. The first byte chooses. OpenColorIO and yaml-cpp are not instrumented.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz/private_folder.h"
#include "ocio/added_record.h"
#include "ocio/read_config.h"
#include "ocio/yaml_text.h"
#include "tonewright/error.h"
#include "tonewright/lut_file.h"

namespace {

using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program

void read(const std::string& text) { (void)read_config("x.ocio", text); }

/// Added items can be removed again: the text is as it was.
void extend(const std::string& text) {
    YamlText yaml(text);
    const YAML::Node item = YAML::Load("!<View> {name: a b, view_transform: \"c, d\"}");
    const YAML::Node block =
        YAML::Load("!<ViewTransform>\n  name: a\n  description: |\n    b\n    c\n");
    const YAML::Node root = yaml.root();
    if (!root.IsMap()) return;
    for (const auto& entry : root) {
        if (entry.second.IsSequence()) yaml.append(entry.second, {item, block});
        if (entry.second.IsScalar()) yaml.append_text(entry.second, ", e");
        if (!entry.second.IsMap()) continue;
        for (const auto& inner : entry.second) {
            if (inner.second.IsSequence()) yaml.append(inner.second, {item});
        }
    }
    yaml.add("looks_of_ours", {block});
    yaml.add_text("views_of_ours", "[f]");
    const std::string result = yaml.result();
    AddedRecord record;
    record.add(yaml.insertions(), result);
    try {
        if (record.without(result, "x.ocio") != text) std::abort();
    } catch (const FileError&) {
        // A piece that stands in the text twice cannot be told from the other one.
    }
}

/// A record beside a config that has only its first added text.
void read_record(const std::string& text) {
    static const PrivateFolder folder;
    const std::string config = folder.path() + "/x.ocio";
    (void)folder.write("tonewright/x.ocio.yaml", text);
    const std::string bare = "ocio_profile_version: 2\n";
    const AddedRecord record = AddedRecord::read(config, bare);
    std::string whole = bare;
    for (const AddedRecord::Piece& piece : record.pieces)
        whole += piece.before + piece.text;
    (void)record.without(whole, config);
    // A record that is read can be written and read again.
    const std::string written = record.text(bare);
    (void)folder.write("tonewright/x.ocio.yaml", written);
    if (AddedRecord::read(config, bare).text(bare) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool is_silent = [] {
        silence_opencolorio();
        return true;
    }();
    if (size == 0 || !is_silent) return 0;
    const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        switch (data[0] % 3) {
            case 0:
                read(text);
                break;
            case 1:
                extend(text);
                break;
            default:
                read_record(text);
                break;
        }
    } catch (const YAML::Exception&) {
        // The callers add the name of the file.
    } catch (const FileError& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
