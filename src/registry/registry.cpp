// SPDX-License-Identifier: Apache-2.0
#include "tonewright/registry.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "base/strings.h"
#include "local/operators.h"
#include "registry/engines.h"
#include "tonewright/definition.h"
#include "tonewright/engines.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Result of a name.
struct NamedOperator {
    const Operator* op = nullptr;
    const Preset* preset = nullptr;
    std::string look;
    std::shared_ptr<const Operator> owner;  // of an operator that is not built in
};
using NamedOperators = std::map<std::string, NamedOperator>;

/// By folded name. Ids come first, so that no title can hide one.
NamedOperators by_name(const std::vector<const Operator*>& operators) {
    NamedOperators names;
    for (const Operator* op : operators)
        names.emplace(folded_name(op->id), NamedOperator{op, nullptr, {}, {}});
    for (const Operator* op : operators) {
        for (const std::string& name : {op->view, op->title}) {
            if (name.empty()) continue;
            names.emplace(folded_name(name), NamedOperator{op, nullptr, {}, {}});
            for (const Look& look : op->looks) {
                names.emplace(folded_name(name + " " + look.title),
                              NamedOperator{op, nullptr, look.id, {}});
            }
            for (const Preset& preset : op->presets) {
                names.emplace(folded_name(name + " " + preset.title),
                              NamedOperator{op, &preset, {}, {}});
            }
        }
    }
    return names;
}

const NamedOperators& operators_by_name() {
    static const NamedOperators all = [] {
        std::vector<const Operator*> operators;
        for (const std::vector<Operator>* some : {&all_operators(), &local_operators()}) {
            for (const Operator& op : *some)
                operators.push_back(&op);
        }
        return by_name(operators);
    }();
    return all;
}

/// Operators that people look for and that are not available; docs/choosing.md has the reasons.
struct AbsentOperator {
    const char* name;
    const char* note;
};
constexpr const char* kFilmic =
    "Blender's Filmic is a table without a formula: give its LUT file as the operator "
    "(docs/choosing.md); filmic formulas are hable and unreal";
constexpr const char* kTony =
    "Tony McMapface is a table without a formula: give its LUT file as the operator "
    "(docs/choosing.md)";
constexpr AbsentOperator kAbsentOperators[] = {
    {"filmic", kFilmic},
    {"filmic_blender", kFilmic},
    {"tony_mcmapface", kTony},
    {"tonymcmapface", kTony},
    {"opendrt", "OpenDRT cannot be derived from its description (docs/choosing.md)"},
};

/// `op` is null if there is no such name.
NamedOperator known_by(std::string_view name, const OperatorSet& others) {
    const std::string folded = folded_name(name);
    const auto found = operators_by_name().find(folded);
    if (found != operators_by_name().end()) return found->second;
    for (const std::shared_ptr<const Operator>& op : others.operators()) {
        const NamedOperators names = by_name({op.get()});
        if (const auto own = names.find(folded); own != names.end()) {
            NamedOperator named = own->second;
            named.owner = op;
            return named;
        }
    }
    return {};
}

std::string_view absence_of(std::string_view name) {
    for (const AbsentOperator& absent : kAbsentOperators) {
        if (is_same_name(absent.name, name)) return absent.note;
    }
    return {};
}

/// @throws AmbiguousNameError  the name means tone mappers of several programs
void refuse_ambiguous(std::string_view name, Problem problem) {
    std::vector<std::string> meanings;
    for (const NameMeaning& meaning : meanings_of(name)) {
        if (!meaning.op.empty()) meanings.push_back(meaning.op);
    }
    if (meanings.empty()) return;
    problem.expected = join_choices(meanings) + "; programs that use the name: <<list=engines>>";
    if (const std::string_view note = absence_of(name); !note.empty())
        problem.expected.append("; ").append(note);
    problem.suggestion.clear();
    throw AmbiguousNameError(problem, std::string(name));
}

NamedOperator find_named(std::string_view name, const OperatorSet& others = {}) {
    if (NamedOperator known = known_by(name, others); known.op) return known;
    std::vector<NamedChoice> choices;
    for (const std::shared_ptr<const Operator>& op : others.operators())
        choices.push_back({op->id, {op->view, op->title}});
    for (const std::vector<Operator>* operators : {&all_operators(), &local_operators()}) {
        for (const Operator& op : *operators)
            choices.push_back({op.id, {op.view, op.title}});
    }
    const std::string shown = trimmed(name).empty() ? "empty" : std::string(name);
    Problem problem = {.what = "operator is " + shown,
                       .expected = "an id from <<list=operators>>",
                       .suggestion = suggested_names(name, choices)};
    refuse_ambiguous(name, problem);
    if (const std::string others_of_program = tone_mappers_of_program(name);
        !others_of_program.empty()) {
        problem.expected += ", or " + others_of_program;
        problem.suggestion.clear();
    }
    if (const std::string_view note = absence_of(name); !note.empty()) {
        // A name that people look for has a better answer than the nearest one.
        problem.expected.append("; ").append(note);
        problem.suggestion.clear();
    }
    throw Error(problem);
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// True for a text that begins with `name=`, blanks before it.
bool begins_with_setting(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return false;
    const std::size_t end = text.find_first_not_of(
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-", begin);
    return end != std::string_view::npos && end > begin && text[end] == '=';
}

/// The parts of an operator's text: its name, presets, settings.
std::vector<std::string> parts_of(std::string_view text) {
    constexpr std::string_view kMarked = ":\\ \t";
    std::vector<std::string> parts(1);
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\\' && i + 1 < text.size() && kMarked.find(text[i + 1]) != kMarked.npos) {
            parts.back() += text[++i];
        } else if (c == ':') {
            parts.emplace_back();
        } else if (is_blank(c) && begins_with_setting(text.substr(i))) {
            i = text.find_first_not_of(" \t", i) - 1;
            if (!parts.back().empty()) parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

/// True if the path of a file may end here, at the end of an extension.
bool is_end_of_path(std::string_view text, std::size_t end) {
    constexpr std::string_view kExtension = ".tone";
    if (end < text.size() && text[end] != ':' &&
        !(is_blank(text[end]) && begins_with_setting(text.substr(end))))
        return false;
    const std::string path = lowercase(text.substr(0, end));
    const std::vector<std::string>& tables = table_extensions();
    return path.ends_with(kExtension) ||
           std::any_of(tables.begin(), tables.end(),
                       [&](const std::string& extension) { return path.ends_with(extension); });
}

/// The length of the path of a file that the text begins with; 0 if it names no file.
std::size_t file_length(std::string_view text) {
    if (text.find('.') == std::string_view::npos) return 0;
    for (std::size_t end = text.find_first_of(": \t"); true;
         end = text.find_first_of(": \t", end + 1)) {
        const std::size_t stop = std::min(end, text.size());
        if (is_end_of_path(text, stop)) {
            const bool is_operator =
                operators_by_name().contains(folded_name(parts_of(text).front()));
            return is_operator ? 0 : stop;
        }
        if (stop == text.size()) return 0;
    }
}

/// A value as parts_of() reads it back.
std::string marked(std::string_view value) {
    std::string text;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const char c = value[i];
        const bool is_apart = is_blank(c) && begins_with_setting(value.substr(i));
        if (c == ':' || c == '\\' || is_apart) text += '\\';
        text += c;
    }
    return text;
}

/// The parameter's own name; or the text if there is none, and resolve() reports it.
std::string parameter_name(const Operator& op, std::string_view text) {
    for (const ParameterSpec& spec : op.parameters) {
        if (is_same_name(spec.name, text)) return spec.name;
    }
    return std::string(text);
}

/// Adds a setting to others.
/// @throws Error  they contradict each other
void add_setting(Settings& settings, const Operator& op, std::string_view name,
                 const std::string& value) {
    const auto [known, is_new] = settings.emplace(parameter_name(op, name), value);
    if (is_new || known->second == value) return;
    throw Error(op.id + ": " + known->first + " is " + known->second + " and " + value +
                "; expected it once");
}

/// Names places that have a parameter which the operator lacks: its looks, and other dialects.
std::string elsewhere(const Operator& op, std::string_view name) {
    const auto has = [&](const Operator& other) {
        return std::any_of(
            other.parameters.begin(), other.parameters.end(),
            [&](const ParameterSpec& spec) { return is_same_name(spec.name, name); });
    };
    if (has(op)) return {};
    const std::string folded = folded_name(name);
    std::vector<std::string> looks;
    for (const Look& look : op.looks) {
        if (folded_name(look.id).find(folded) != std::string::npos) looks.push_back(look.id);
    }
    std::string note;
    if (!looks.empty()) note += "; looks for it: <<look=" + join_choices(looks) + ">>";
    if (op.dialects.empty()) return note;
    std::vector<std::string> others;
    for (const Operator& other : all_operators()) {
        if (other.dialects == op.dialects && has(other)) others.push_back(other.id);
    }
    if (!others.empty()) note += "; operators with it: " + join_choices(others);
    return note;
}

void set_look(std::string& look, const Operator& op, std::string_view requested) {
    if (requested.empty() || is_same_name(look, requested)) return;
    if (!look.empty())
        throw Error(op.id + ": look is " + look + " and " + std::string(requested) +
                    "; expected one");
    look = requested;
}

/// resolve(), whose error names where an unknown parameter is.
ResolvedOperator resolve_helpfully(const Operator& op, const Preset* preset,
                                   const Settings& settings, std::string_view look) {
    try {
        return resolve(op, preset, settings, look);
    } catch (const Error& e) {
        for (const auto& [name, value] : settings) {
            if (const std::string note = elsewhere(op, name); !note.empty())
                throw Error(e.text() + note);
        }
        throw;
    }
}

/// The parts, where the name is that of a program's tone mapper, with its operator instead.
/// @throws Error  no operator computes this tone mapper
std::vector<std::string> without_program(const std::vector<std::string>& parts) {
    const EngineToneMapper* row = find_engine_tone_mapper(parts.front());
    if (!row) return parts;
    if (row->op.empty()) {
        throw Error(Problem{.what = "operator is " + parts.front() +
                                    ", which no operator computes (" + row->note + ")",
                            .expected = "an id from <<list=operators>>"});
    }
    std::vector<std::string> own = parts_of(row->op);
    own.insert(own.end(), parts.begin() + 1, parts.end());
    return own;
}

ResolvedOperator resolve_text(std::string_view text, const Settings& settings,
                              std::string_view look, bool takes_local, const OperatorSet& others) {
    // A path is followed by the same settings as a name.
    const std::size_t length = file_length(text);
    std::string rest(text.substr(length));
    if (length > 0 && !rest.empty() && rest.front() != ':') rest.insert(0, ":");
    std::vector<std::string> parts = parts_of(rest);
    NamedOperator named;
    if (length == 0 && !known_by(parts.front(), others).op) parts = without_program(parts);
    if (length == 0 && others.takes_formulas() && may_be_formula(text) &&
        !known_by(parts.front(), others).op) {
        parts = {std::string(text)};
        named.owner = formula_operator(text);
        named.op = named.owner.get();
    } else if (length > 0) {
        named.owner = load_operator(std::string(text.substr(0, length)), others.tables());
        named.op = named.owner.get();
    } else {
        named = find_named(parts.front(), others);
    }
    const Operator& op = *named.op;
    if (!takes_local) require_no_surroundings(op);
    Settings all;
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const std::string& part = parts[i];
        const std::size_t equals = part.find('=');
        if (equals == std::string::npos) {
            if (named.preset)
                throw Error(op.id + ": preset is " + named.preset->id + " and " + part +
                            "; expected one");
            named.preset = &find_preset(op, part);
        } else if (is_same_name(part.substr(0, equals), "look")) {
            set_look(named.look, op, part.substr(equals + 1));
        } else {
            add_setting(all, op, part.substr(0, equals), part.substr(equals + 1));
        }
    }
    for (const auto& [name, value] : settings)
        add_setting(all, op, name, value);
    set_look(named.look, op, look);
    ResolvedOperator resolved = resolve_helpfully(op, named.preset, all, named.look);
    resolved.owner = named.owner;
    return resolved;
}

}  // namespace

const std::vector<Operator>& local_operators() {
    static const std::vector<Operator> all = {define_exposure_fusion(), define_local_laplacian(),
                                              define_reinhard_local()};
    return all;
}

const Operator& find_picture_operator(std::string_view name) { return *find_named(name).op; }

const Operator& find_operator(std::string_view name) {
    const Operator& op = find_picture_operator(name);
    require_no_surroundings(op);
    return op;
}

void require_no_surroundings(const Operator& op) {
    if (!op.is_local()) return;
    throw Error(
        Problem{.what = "operator is " + op.id + ", a local operator, which needs a picture",
                .expected = "an operator that <<list=operators>> does not mark as local, or "
                            "<<task=apply>> with a picture"});
}

ResolvedOperator resolve_operator(std::string_view text, const Settings& settings,
                                  std::string_view look, const OperatorSet& others) {
    return resolve_text(text, settings, look, false, others);
}

ResolvedOperator resolve_picture_operator(std::string_view text, const Settings& settings,
                                          std::string_view look, const OperatorSet& others) {
    return resolve_text(text, settings, look, true, others);
}

ResolvedOperator with_defaults(const ResolvedOperator& own, const Settings& settings,
                               std::string_view look) {
    Settings all;
    for (const auto& [name, value] : settings)
        add_setting(all, *own.op, name, value);
    for (const auto& [name, value] : own.settings)
        all[name] = value;
    const std::string& own_look = own.params.look();
    ResolvedOperator result =
        resolve_helpfully(*own.op, own.preset, all, own_look.empty() ? look : own_look);
    result.owner = own.owner;
    return result;
}

std::vector<ResolvedOperator> resolve_operators(const std::vector<std::string>& texts,
                                                const OperatorSet& others) {
    std::vector<ResolvedOperator> operators;
    bool has_all = false;
    for (const std::string& text : texts) {
        if (is_same_name(text, "all")) {
            has_all = true;
        } else {
            operators.push_back(resolve_operator(text, {}, {}, others));
        }
    }
    if (!has_all) return operators;
    operators.clear();
    for (const OperatorVariant& v : all_variants())
        operators.push_back(resolve_operator(v.name, {}, v.look));
    return operators;
}

bool names_a_file(std::string_view text) { return file_length(text) > 0; }

bool names_a_lut(std::string_view text) {
    const std::vector<std::string>& tables = table_extensions();
    const std::string extension = extension_of(std::string(text.substr(0, file_length(text))));
    return std::find(tables.begin(), tables.end(), extension) != tables.end();
}

void OperatorSet::add(std::shared_ptr<const Operator> op) {
    for (const auto& [name, named] : by_name({op.get()})) {
        bool is_taken = operators_by_name().contains(name);
        for (const std::shared_ptr<const Operator>& other : operators_)
            is_taken = is_taken || by_name({other.get()}).contains(name);
        if (!is_taken) continue;
        throw Error("operator is " + op->id + "; expected names that no other operator has, but " +
                    name + " is one");
    }
    operators_.push_back(std::move(op));
}

std::string operator_text(const ResolvedOperator& op) {
    const std::string& look = op.params.look();
    const auto params_of = [&](const Settings& settings) {
        return resolve(*op.op, op.preset, settings, look).params;
    };
    std::string text = op.name();
    const Params all = params_of(op.settings);
    for (const auto& [name, value] : op.settings) {
        Settings others = op.settings;
        others.erase(name);
        bool matters = true;
        try {
            matters = !(params_of(others) == all);
        } catch (const Error&) {
            // Without it, the others contradict each other.
        }
        if (matters) text += ":" + name + "=" + marked(value);
    }
    return look.empty() ? text : text + ":look=" + look;
}

std::vector<OperatorVariant> all_variants() {
    std::vector<OperatorVariant> all;
    for (const Operator& op : all_operators()) {
        all.push_back({op.id, ""});
        for (const Preset& preset : op.presets)
            all.push_back({op.id + ":" + preset.id, ""});
        for (const Look& look : op.looks)
            all.push_back({op.id, look.id});
    }
    return all;
}

TONEWRIGHT_NAMESPACE_END
