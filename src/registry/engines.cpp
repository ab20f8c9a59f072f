// SPDX-License-Identifier: Apache-2.0
#include "registry/engines.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "base/strings.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Verdict = EngineToneMapper::Verdict;

/// Names that programs share, and that people use without one.
constexpr const char* kAmbiguousNames[] = {"ACES", "ACESFilmic", "Cineon",    "Filmic",
                                           "Hejl", "Neutral",    "Uncharted", "Uncharted2"};

/// A name as names with a program are compared: letters and digits. Empty if it has control
/// characters, which no name has.
std::string key_of(std::string_view name) {
    std::string key;
    for (const char c : lowercase(name)) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20 || code == 0x7F) return {};
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || code >= 0x80) key += c;
    }
    return key;
}

/// Further keys of programs whose names are long.
constexpr std::pair<std::string_view, std::string_view> kShortPrograms[] = {
    {"Mapbox GL JS", "mapbox"},
    {"Mapbox GL JS", "mapboxgl"},
    {"Needle Engine", "needle"},
    {"luma.gl", "luma"},
    {"CesiumJS", "cesium"}};

std::vector<std::string> keys_of_program(const std::string& program) {
    std::vector<std::string> keys = {key_of(program)};
    if (keys[0].ends_with("js")) keys.push_back(keys[0].substr(0, keys[0].size() - 2));
    for (const auto& [name, key] : kShortPrograms) {
        if (name == program) keys.emplace_back(key);
    }
    return keys;
}

std::vector<std::string> keys_of_names(const EngineToneMapper& row) {
    std::vector<std::string> keys = {key_of(row.name)};
    for (const std::string& name : row.names)
        keys.push_back(key_of(name));
    return keys;
}

/// By program and name, and by program, version and name.
const std::map<std::string, const EngineToneMapper*>& rows_by_key() {
    static const std::map<std::string, const EngineToneMapper*> all = [] {
        std::map<std::string, const EngineToneMapper*> keys;
        for (const EngineToneMapper& row : engine_tone_mappers()) {
            for (const std::string& program : keys_of_program(row.program)) {
                for (const std::string& name : keys_of_names(row)) {
                    keys.emplace(program + name, &row);
                    keys.emplace(program + key_of(row.version) + name, &row);
                }
            }
        }
        return keys;
    }();
    return all;
}

/// True for an id that has the name's words side by side: `aces` in aces_20.
bool has_words(std::string_view id, std::string_view name) {
    return ("_" + std::string(id) + "_").find("_" + folded_name(name) + "_") != std::string::npos;
}

}  // namespace

std::string_view name_of(Verdict verdict) {
    if (verdict == Verdict::equal) return "equal";
    return verdict == Verdict::nearest ? "nearest" : "none";
}

const EngineToneMapper* find_engine_tone_mapper(std::string_view name) {
    const auto found = rows_by_key().find(key_of(name));
    return found == rows_by_key().end() ? nullptr : found->second;
}

std::string tone_mappers_of_program(std::string_view name) {
    const std::string key = key_of(name);
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        const std::vector<std::string> programs = keys_of_program(row.program);
        if (std::none_of(programs.begin(), programs.end(),
                         [&](const std::string& program) { return key.starts_with(program); }))
            continue;
        std::vector<std::string> names;
        for (const EngineToneMapper& other : engine_tone_mappers()) {
            if (other.program != row.program || other.verdict == Verdict::none) continue;
            const std::string& own = other.names.empty() ? other.name : other.names.front();
            // Versions share names.
            if (std::find(names.begin(), names.end(), own) == names.end()) names.push_back(own);
        }
        return row.program + " with " + join_choices(names);
    }
    return {};
}

std::vector<NameMeaning> meanings_of(std::string_view name) {
    std::vector<NameMeaning> meanings;
    const auto add = [&](const std::string& op, std::string use) {
        auto known = std::find_if(meanings.begin(), meanings.end(),
                                  [&](const NameMeaning& meaning) { return meaning.op == op; });
        if (known == meanings.end()) known = meanings.insert(known, {op, {}});
        if (std::find(known->uses.begin(), known->uses.end(), use) == known->uses.end())
            known->uses.push_back(std::move(use));
    };
    const std::string key = key_of(name);
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        const std::vector<std::string> names = keys_of_names(row);
        if (std::find(names.begin(), names.end(), key) != names.end())
            add(row.op, row.program + " " + row.name);
    }
    if (meanings.empty()) return meanings;
    for (const Operator& op : all_operators()) {
        if (has_words(op.id, name)) add(op.id, op.title);
    }
    // Those without an operator have nothing to choose.
    std::stable_partition(meanings.begin(), meanings.end(),
                          [](const NameMeaning& meaning) { return !meaning.op.empty(); });
    return meanings;
}

const std::vector<std::string>& ambiguous_names() {
    static const std::vector<std::string> all(std::begin(kAmbiguousNames),
                                              std::end(kAmbiguousNames));
    return all;
}

std::string note_on_name(std::string_view text) {
    const std::string_view name = text.substr(0, text.find(':'));
    if (is_same_name(name, "AgX"))
        return "AgX is Blender's here; other programs have their own: <<list=engines>>";
    const EngineToneMapper* row = find_engine_tone_mapper(name);
    if (!row || row->verdict != Verdict::nearest) return {};
    return row->program + " " + row->name + ": " + row->op + " is the nearest operator" +
           (row->note.empty() ? "" : "; " + row->note);
}

TONEWRIGHT_NAMESPACE_END
