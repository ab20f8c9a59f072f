// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>

#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "definition/primaries_names.h"
#include "definition/recipe.h"
#include "definition/table_stages.h"
#include "definition/toml_text.h"
#include "tonewright/definition.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kLongestFile = std::size_t{1} << 20U;

using Value = TomlValue;
using Names = std::vector<std::string>;

[[noreturn]] void fail(TextPosition at, const std::string& message) {
    throw TomlError(at, message);
}

/// A value as messages have it.
std::string described(const Value& value) {
    switch (value.kind) {
        case Value::Kind::boolean:
            return value.boolean ? "true" : "false";
        case Value::Kind::number:
            return shortest(value.number);
        case Value::Kind::text:
            return "\"" + printable(value.text) + "\"";
        case Value::Kind::date:
            return "a date";
        case Value::Kind::array:
            return "an array of " + std::to_string(value.items.size());
        case Value::Kind::table:
            break;
    }
    return "a table of " + std::to_string(value.members.size());
}

/// The members of a table; an unknown one is an error.
class Table {
  public:
    /// @param what  the table in messages: "[parameter.k]"; empty for the file
    Table(const Value& value, std::string what, const Names& known)
        : value_(value), what_(std::move(what)) {
        if (value.kind != Value::Kind::table)
            fail(value.at, what_ + " is " + described(value) + "; expected a table");
        for (const Value& member : value.members) {
            if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
            fail(member.key_at, in_table("key is " + printable(member.key)) + "; expected " +
                                    join_choices(known) + did_you_mean(member.key, known));
        }
    }

    [[nodiscard]] const Value* find(std::string_view key) const {
        for (const Value& member : value_.members) {
            if (member.key == key) return &member;
        }
        return nullptr;
    }
    [[nodiscard]] const Value& require(const std::string& key) const {
        if (const Value* value = find(key)) return *value;
        fail(value_.at, in_table("key " + key + " is missing") + "; expected it");
    }
    [[nodiscard]] std::string text(const std::string& key,
                                   const std::string& otherwise = "") const {
        const Value* value = find(key);
        return value ? text_of(*value, key) : otherwise;
    }
    [[nodiscard]] double number(const std::string& key, double otherwise) const {
        const Value* value = find(key);
        return value ? number_of(*value, key) : otherwise;
    }
    /// The index of the text in choices; without the key, the first one.
    [[nodiscard]] std::size_t choice(const std::string& key, const Names& choices) const {
        return find(key) ? required_choice(key, choices) : 0;
    }
    [[nodiscard]] std::size_t required_choice(const std::string& key, const Names& choices) const {
        const Value& value = require(key);
        const auto found = std::find(choices.begin(), choices.end(), text_of(value, key));
        if (found == choices.end()) {
            fail(value.at, in_table(key + " is " + described(value)) + "; expected " +
                               join_choices(choices) + did_you_mean(value.text, choices));
        }
        return static_cast<std::size_t>(found - choices.begin());
    }
    [[nodiscard]] const std::vector<Value>& members() const { return value_.members; }

    /// One line of text, because docs put `negatives` and others into tables.
    static std::string text_of(const Value& value, const std::string& key) {
        if (value.kind != Value::Kind::text)
            fail(value.at, key + " is " + described(value) + "; expected text in quotes");
        return value.text;
    }
    static double number_of(const Value& value, const std::string& key,
                            bool may_be_infinite = false) {
        if (value.kind != Value::Kind::number)
            fail(value.at, key + " is " + described(value) + "; expected a number");
        if (std::isnan(value.number) || (std::isinf(value.number) && !may_be_infinite))
            fail(value.at, key + " is " + described(value) + "; expected a finite number");
        return value.number;
    }
    static const std::vector<Value>& items_of(const Value& value, std::string_view key,
                                              std::size_t count) {
        if (value.kind != Value::Kind::array || value.items.size() != count) {
            fail(value.at, std::string(key) + " is " + described(value) +
                               "; expected an array of " + std::to_string(count));
        }
        return value.items;
    }

  private:
    [[nodiscard]] std::string in_table(const std::string& message) const {
        return what_.empty() ? message : what_ + ": " + message;
    }
    const Value& value_;
    std::string what_;
};

class Reader {
  public:
    Reader(std::string_view text, const std::string& name, const TableReader& tables)
        : text_(text), tables_(tables) {
        op_.file = name;
    }

    std::shared_ptr<const Operator> read() {
        const Value root = parse_toml(text_);
        const Table file(root, "",
                         {"tonewright", "id", "title", "view", "character", "source", "license",
                          "negatives", "warnings", "primaries", "output", "parameter", "preset",
                          "look", "deviation", "bounds", "stage", "inverse"});
        read_head(file);
        read_primaries(file);
        read_parameters(file);
        read_looks(file);
        read_output(file);
        recipe_->stages = read_stages(file, "stage");
        if (recipe_->stages.empty()) fail({}, "file has no [[stage]]; expected at least one");
        recipe_->inverse = read_stages(file, "inverse");
        read_declarations(file);
        op_.parameters = recipe_->parameters;
        set_functions();
        read_presets(file);
        auto op = std::make_shared<const Operator>(std::move(op_));
        build_all(*op, root);
        return op;
    }

  private:
    void read_head(const Table& file) {
        const Value& version = file.require("tonewright");
        if (Table::number_of(version, "tonewright") != 1)
            fail(version.at, "tonewright is " + described(version) + "; expected 1");
        const Value& id = file.require("id");
        op_.id = Table::text_of(id, "id");
        if (!is_id(op_.id)) {
            fail(id.at, "id is " + described(id) +
                            "; expected at most 63 small letters, digits and _, a letter first");
        }
        op_.title = line(file, "title", op_.id);
        op_.view = line(file, "view", op_.title);
        if (op_.view.size() > kLongestName)
            fail(file.find("view") ? file.find("view")->at : file.find("title")->at,
                 "view is " + printable(op_.view) + "; expected at most 63 bytes");
        op_.character = line(file, "character", "");
        op_.source = line(file, "source", "");
        op_.license = line(file, "license", "");
        op_.negatives = line(file, "negatives", "");
        if (const Value* warnings = file.find("warnings")) {
            if (warnings->kind != Value::Kind::array)
                fail(warnings->at, "warnings is " + described(*warnings) + "; expected an array");
            for (const Value& warning : warnings->items)
                op_.warnings.push_back(one_line(Table::text_of(warning, "warnings")));
        }
    }

    static std::string line(const Table& table, const std::string& key,
                            const std::string& otherwise) {
        const Value* value = table.find(key);
        if (!value) return otherwise;
        const std::string text = Table::text_of(*value, key);
        std::string clean(trimmed(one_line(text)));
        if (clean.empty() && !otherwise.empty()) fail(value->at, key + " is empty; expected text");
        return clean;
    }

    static Primaries primaries_of(const Value& value, const std::string& key) {
        if (value.kind == Value::Kind::text) {
            const auto& all = named_primaries();
            const auto found = std::find_if(all.begin(), all.end(), [&](const auto& named) {
                return named.first == value.text;
            });
            if (found != all.end()) return found->second;
            Names names;
            for (const auto& named : all)
                names.emplace_back(named.first);
            fail(value.at, key + " is " + described(value) + "; expected " + join_choices(names) +
                               did_you_mean(value.text, names));
        }
        const Table table(value, key, {"red", "green", "blue", "white"});
        const auto chromaticity = [&](const char* which) -> Chromaticity {
            const std::string name = key + "." + which;
            const auto& xy = Table::items_of(table.require(which), name, 2);
            return {Table::number_of(xy[0], name), Table::number_of(xy[1], name)};
        };
        const Primaries own = {"own", chromaticity("red"), chromaticity("green"),
                               chromaticity("blue"), chromaticity("white")};
        bool is_finite = own.whitepoint.y != 0;
        try {
            for (const auto& row : is_finite ? inverse(rgb_to_xyz(own)) : kIdentity3) {
                for (const double v : row)
                    is_finite = is_finite && std::isfinite(v);
            }
        } catch (const Error&) {  // their determinant is 0
            is_finite = false;
        }
        if (!is_finite)
            fail(value.at,
                 key + " spans no colors; expected three colors that do not lie in a line");
        return own;
    }

    void read_primaries(const Table& file) {
        recipe_->output_primaries = op_.working;
        const Value* value = file.find("primaries");
        if (!value) return;
        const Table table(*value, "[primaries]", {"working", "output"});
        if (const Value* working = table.find("working"))
            op_.working = primaries_of(*working, "working");
        const Value* output = table.find("output");
        recipe_->output_primaries = output ? primaries_of(*output, "output") : op_.working;
    }

    /// For [WHAT.NAME].
    static void require_names(const Value& all, const std::string& what) {
        if (all.kind == Value::Kind::table && all.members.size() <= kMostNames) return;
        fail(all.at, what + " is " + described(all) + "; expected [" + what + ".NAME], at most " +
                         std::to_string(kMostNames));
    }

    // -- Parameters

    void read_parameters(const Table& file) {
        const Value* all = file.find("parameter");
        if (!all) return;
        require_names(*all, "parameter");
        for (const Value& member : all->members) {
            const std::string why = why_no_parameter(member.key, recipe_->parameters);
            if (!why.empty()) fail(member.key_at, why);
            const std::string what = "[parameter." + member.key + "]";
            const Table table(member, what,
                              {"default", "min", "max", "unit", "doc", "choices", "from_picture",
                               "from_display"});
            ParameterSpec spec;
            spec.name = member.key;
            spec.unit = line(table, "unit", "");
            spec.help = line(table, "doc", "");
            if (table.find("choices")) {
                read_choices(spec, table);
            } else {
                read_number(spec, table);
            }
            scope_.names.emplace(spec.name, FormulaValue{Expr::uniform(spec.name)});
            for (std::size_t i = 0; i < spec.choices.size(); ++i)
                scope_.names.emplace(spec.name + "." + spec.choices[i], FormulaValue{double(i)});
            recipe_->parameters.push_back(std::move(spec));
        }
    }

    static void read_choices(ParameterSpec& spec, const Table& table) {
        spec.kind = ParameterSpec::Kind::choice;
        const Value& choices = *table.find("choices");
        if (choices.kind != Value::Kind::array || choices.items.empty() ||
            choices.items.size() > kMostNames) {
            fail(choices.at, "choices is " + described(choices) +
                                 "; expected an array of names, at most " +
                                 std::to_string(kMostNames));
        }
        for (const Value& choice : choices.items) {
            const std::string name = Table::text_of(choice, "choices");
            const bool is_known =
                std::find(spec.choices.begin(), spec.choices.end(), name) != spec.choices.end();
            if (!is_id(name) || is_known) {
                fail(choice.at, "choice is " + described(choice) +
                                    "; expected small letters, digits and _, a letter first, and "
                                    "each choice once");
            }
            spec.choices.push_back(name);
        }
        for (const char* key : {"min", "max", "from_picture"}) {
            if (const Value* value = table.find(key))
                fail(value->at, std::string(key) + " is given with choices; expected one of them");
        }
        spec.default_choice = spec.choices[table.required_choice("default", spec.choices)];
        if (!table.find("from_display")) return;
        if (table.choice("from_display", {"range", "gamut"}) == 0) {
            spec.from_display = [](const DisplayFacts& d) -> std::string {
                return d.is_hdr ? "hdr" : "sdr";
            };
            require_choices(spec, table, {"sdr", "hdr"});
        } else {
            spec.from_display = [](const DisplayFacts& d) -> std::string {
                if (d.primaries == kRec709) return "rec709";
                return d.primaries == kP3D65 ? "p3d65" : "rec2020";
            };
            require_choices(spec, table, {"rec709", "p3d65", "rec2020"});
        }
    }

    static void require_choices(const ParameterSpec& spec, const Table& table,
                                const Names& needed) {
        for (const std::string& name : needed) {
            if (std::find(spec.choices.begin(), spec.choices.end(), name) != spec.choices.end())
                continue;
            fail(table.find("from_display")->at, "from_display needs the choices " +
                                                     join_choices(needed) +
                                                     "; expected all of them");
        }
    }

    static void read_number(ParameterSpec& spec, const Table& table) {
        const Value& value = table.require("default");
        spec.default_value = Table::number_of(value, "default");
        spec.min = Table::number_of(table.require("min"), "min");
        spec.max = Table::number_of(table.require("max"), "max");
        if (spec.min > spec.max)
            fail(table.find("min")->at, "min is " + shortest(spec.min) + "; expected at most max");
        if (spec.default_value < spec.min || spec.default_value > spec.max) {
            fail(value.at, "default is " + shortest(spec.default_value) + "; expected [" +
                               shortest(spec.min) + ", " + shortest(spec.max) + "]");
        }
        if (table.find("from_picture")) {
            using Field = double SceneStatistics::*;
            const std::pair<const char*, Field> fields[] = {
                {"log_average", &SceneStatistics::log_average},
                {"mean_luminance", &SceneStatistics::mean_luminance},
                {"minimum_luminance", &SceneStatistics::minimum_luminance},
                {"maximum_luminance", &SceneStatistics::maximum_luminance}};
            Names names;
            for (const auto& field : fields)
                names.emplace_back(field.first);
            const auto& [name, field] = fields[table.choice("from_picture", names)];
            spec.statistic = std::string(name) + " of the picture";
            std::replace(spec.statistic.begin(), spec.statistic.end(), '_', ' ');
            const Field member = field;
            spec.from_picture = [member](const SceneStatistics& s) { return s.*member; };
        }
        if (table.find("from_display")) {
            (void)table.choice("from_display", {"peak"});  // the only one
            const double lo = spec.min;
            const double hi = spec.max;
            spec.from_display = [lo, hi](const DisplayFacts& d) {
                return shortest(std::clamp(d.peak, lo, hi));
            };
        }
    }

    void read_looks(const Table& file) {
        const Value* all = file.find("look");
        if (!all) return;
        scope_.names.emplace(kLookName, FormulaValue{Expr::uniform(kLookName)});
        scope_.names.emplace(std::string(kLookName) + ".none", FormulaValue{0});
        require_names(*all, "look");
        for (const Value& member : all->members) {
            if (!is_id(member.key) || member.key == "none") {
                fail(member.key_at, "look is " + printable(member.key) +
                                        "; expected small letters, digits and _, a letter first");
            }
            const Table table(member, "[look." + member.key + "]", {"title", "doc"});
            op_.looks.push_back(
                {member.key, line(table, "title", member.key), line(table, "doc", "")});
            recipe_->looks.push_back(member.key);
            scope_.names.emplace(std::string(kLookName) + "." + member.key,
                                 FormulaValue{double(op_.looks.size())});
        }
    }

    void read_output(const Table& file) {
        const Value* value = file.find("output");
        if (!value) return;
        const Table table(*value, "[output]", {"kind", "power", "display", "peak"});
        if (table.choice("kind", {"display_linear", "code_value"}) == 1)
            op_.output = OutputKind::code_value;
        if (const Value* display = table.find("display"))
            read_output_display(file, table, *display);
        if (const Value* power = table.find("power")) {
            op_.code_power = Table::number_of(*power, "power");
            if (op_.output != OutputKind::code_value)
                fail(power->at, "power is given without kind = \"code_value\"; expected both");
            if (op_.code_power < 0.1 || op_.code_power > 10)
                fail(power->at, "power is " + described(*power) + "; expected [0.1, 10]");
        }
        if (const Value* peak = table.find("peak")) {
            FormulaScope scope = scope_;
            recipe_->peak = number_or_formula(*peak, "peak", scope);
        }
    }

    /// Code values of a display have its primaries and its largest light.
    void read_output_display(const Table& file, const Table& output, const Value& value) {
        const Display* display = nullptr;
        try {
            display = &find_display(Table::text_of(value, "display"));
        } catch (const TomlError&) {
            throw;
        } catch (const Error& e) {
            fail(value.at, e.text());
        }
        if (op_.output != OutputKind::code_value)
            fail(value.at, "display is given without kind = \"code_value\"; expected both");
        if (const Value* power = output.find("power"))
            fail(power->at, "power is given with display; expected one of them");
        const Value* const primaries = file.find("primaries");
        for (const Value& member : primaries ? primaries->members : std::vector<Value>{}) {
            if (member.key == "output")
                fail(member.at,
                     "output is given with the display of [output]; expected one of them");
        }
        op_.display = [id = display->id](const Params&) { return id; };
        recipe_->output_primaries = display->primaries;
        if (display->is_hdr) recipe_->peak = display->largest_light;
    }

    // -- Stages

    /// The position in the file of a byte of a text value, found by its line.
    [[nodiscard]] TextPosition in_file(const Value& value, TextPosition in_text) const {
        const auto line_of = [](std::string_view text, std::size_t number) {
            for (; number > 1 && !text.empty(); --number)
                text = text.substr(std::min(text.find('\n'), text.size() - 1) + 1);
            const std::string_view first = text.substr(0, text.find('\n'));
            return first.substr(0, first.find('\r'));
        };
        const std::string_view own = line_of(value.text, in_text.line);
        const std::string_view opening = line_of(text_, value.at.line);
        std::size_t begin = 0;  // of the value in its line, in bytes
        for (std::size_t n = 1; begin < opening.size() && n < value.at.column; ++n) {
            do
                ++begin;
            while (begin < opening.size() &&
                   (static_cast<unsigned char>(opening[begin]) & 0xC0U) == 0x80U);
        }
        const std::string_view quoted = opening.substr(begin);
        const bool is_long = quoted.substr(0, 3) == "\"\"\"" || quoted.substr(0, 3) == "'''";
        const bool begins_below = is_long && trimmed(quoted.substr(3)).empty();
        const std::size_t line = value.at.line + in_text.line - 1 + (begins_below ? 1 : 0);
        const std::string_view in = line_of(text_, line);
        const std::size_t found = in.find(own, line == value.at.line ? begin : 0);
        if (found == std::string_view::npos) return value.at;  // it has escapes
        return {line, position_at(in, found).column + in_text.column - 1};
    }

    template <class Parse>
    auto parsed(const Value& value, const Parse& parse) const {
        try {
            return parse(value.text);
        } catch (const FormulaError& e) {
            fail(in_file(value, e.at), e.text());
        }
    }

    [[nodiscard]] Expr formula(const Value& value, const std::string& key,
                               const FormulaScope& scope) const {
        if (value.kind != Value::Kind::text)
            fail(value.at, key + " is " + described(value) + "; expected a formula in quotes");
        return parsed(value, [&](std::string_view text) { return parse_formula(text, scope); });
    }

    [[nodiscard]] Expr number_or_formula(const Value& value, const std::string& key,
                                         const FormulaScope& scope) const {
        if (value.kind == Value::Kind::text) return formula(value, key, scope);
        return Table::number_of(value, key);
    }

    [[nodiscard]] std::vector<Expr> formulas(const Value& value, const std::string& key,
                                             const FormulaScope& scope, std::size_t count) const {
        std::vector<Expr> result;
        for (const Value& item : Table::items_of(value, key, count))
            result.push_back(formula(item, key, scope));
        return result;
    }
    [[nodiscard]] std::vector<Expr> one_or_three(const Value& value, const std::string& key,
                                                 const FormulaScope& scope) const {
        if (value.kind == Value::Kind::array) return formulas(value, key, scope, 3);
        return {formula(value, key, scope)};
    }

    std::vector<StageRecipe> read_stages(const Table& file, const std::string& key) {
        const Value* all = file.find(key);
        if (!all) return {};
        if (all->kind != Value::Kind::array || all->items.size() > kMostStages) {
            fail(all->at, key + " is " + described(*all) + "; expected [[" + key + "]], at most " +
                              std::to_string(kMostStages));
        }
        std::vector<StageRecipe> stages;
        for (const Value& item : all->items)
            stages.push_back(read_stage(item, "[[" + key + "]]"));
        return stages;
    }

    /// A kind of stage, by the key of its main value.
    struct StageReader {
        StageRecipe::Kind kind;
        std::string key;
        Names others;  // keys that only this kind has
        void (Reader::*read)(StageRecipe&, const Table&, const FormulaScope&) const;
    };
    static const std::vector<StageReader>& stage_readers() {
        using Kind = StageRecipe::Kind;
        static const std::vector<StageReader> all = {
            {Kind::matrix, "matrix", {}, &Reader::read_matrix},
            {Kind::curve, "curve", {"apply", "inverse", "weights"}, &Reader::read_curve},
            {Kind::tone_scale, "tone_scale", {"norm", "weights"}, &Reader::read_tone_scale},
            {Kind::hue_preserving, "hue_preserving", {}, &Reader::read_hue_preserving},
            {Kind::hexcone, "hexcone", {}, &Reader::read_hexcone},
            {Kind::cross_talk, "cross_talk", {}, &Reader::read_cross_talk},
            {Kind::clamp, "clamp", {}, &Reader::read_clamp},
            {Kind::lut, "lut", {"input", "space"}, &Reader::read_lut},
        };
        return all;
    }
    static const StageReader& stage_reader_of(const Value& value, const std::string& what) {
        Names kinds;
        for (const StageReader& reader : stage_readers())
            kinds.push_back(reader.key);
        Names any = kinds;
        for (const char* key : {"apply", "inverse", "norm", "weights", "input", "space",
                                "temporaries", "when", "name"})
            any.emplace_back(key);
        const Table all(value, what, any);
        const StageReader* found = nullptr;
        for (const StageReader& reader : stage_readers()) {
            const Value* main = all.find(reader.key);
            if (!main) continue;
            if (found) {
                fail(main->at, fmt::format("{0} has two kinds; expected {1}, and another {0}", what,
                                           join_choices({found->key, reader.key})));
            }
            found = &reader;
        }
        if (!found) fail(value.at, what + " has no kind; expected " + join_choices(kinds));
        return *found;
    }

    StageRecipe read_stage(const Value& value, const std::string& what) {
        using Kind = StageRecipe::Kind;
        const StageReader& reader = stage_reader_of(value, what);
        Names known = {reader.key, "temporaries", "when", "name"};
        known.insert(known.end(), reader.others.begin(), reader.others.end());
        const Table table(value, what, known);
        StageRecipe stage;
        stage.kind = reader.kind;
        stage.at = table.require(reader.key).at;
        if (const Value* name = table.find("name")) {
            const std::string own = Table::text_of(*name, "name");
            if (!is_id(own)) {
                fail(name->at, "name is " + described(*name) +
                                   "; expected small letters, digits and _, a letter first");
            }
            stage.name = kept_name(own);
        }
        if (const Value* when = table.find("when")) {
            stage.when = formula(*when, "when", scope_);
            // A stage is there or is not: its parameters are no inputs of an expression.
            for (const std::string& name : uniforms_of(std::span(&stage.when, 1))) {
                for (ParameterSpec& spec : recipe_->parameters)
                    spec.is_live = spec.is_live && spec.name != name;
            }
        }
        FormulaScope scope = scope_;
        if (stage.kind == Kind::cross_talk) {
            scope.inputs = {"r", "g", "b"};
        } else if (stage.kind != Kind::matrix) {
            scope.inputs = {"x"};
        }
        if (const Value* temporaries = table.find("temporaries")) {
            (void)Table::text_of(*temporaries, "temporaries");  // parsed() expects text
            parsed(*temporaries, [&](std::string_view text) { parse_temporaries(text, scope); });
        }
        (this->*reader.read)(stage, table, scope);
        return stage;
    }

    void read_matrix(StageRecipe& stage, const Table& table, const FormulaScope& scope) const {
        for (const Value& row : Table::items_of(table.require("matrix"), "matrix", 3)) {
            for (const Value& entry : Table::items_of(row, "row of the matrix", 3))
                stage.f.push_back(number_or_formula(entry, "matrix", scope));
        }
    }
    void read_tone_scale(StageRecipe& stage, const Table& table, const FormulaScope& scope) const {
        stage.f = {formula(table.require("tone_scale"), "tone_scale", scope)};
        read_norm(stage, table, table.choice("norm", {"luminance", "max"}) == 1);
    }
    void read_hue_preserving(StageRecipe& stage, const Table& table,
                             const FormulaScope& scope) const {
        stage.f = {formula(table.require("hue_preserving"), "hue_preserving", scope)};
    }
    void read_hexcone(StageRecipe& stage, const Table& table, const FormulaScope& scope) const {
        const Table parts(table.require("hexcone"), "hexcone", {"offset", "value", "chroma"});
        for (const char* part : {"offset", "value", "chroma"})
            stage.f.push_back(formula(parts.require(part), part, scope));
    }
    void read_cross_talk(StageRecipe& stage, const Table& table, const FormulaScope& scope) const {
        stage.f = formulas(table.require("cross_talk"), "cross_talk", scope, 3);
    }
    void read_clamp(StageRecipe& stage, const Table& table, const FormulaScope&) const {
        const Value& main = table.require("clamp");
        const auto& ends = Table::items_of(main, "clamp", 2);
        stage.lo = Table::number_of(ends[0], "clamp", true);
        stage.hi = Table::number_of(ends[1], "clamp", true);
        if (stage.lo > stage.hi)
            fail(main.at, "clamp begins at " + shortest(stage.lo) + "; expected at most its end, " +
                              shortest(stage.hi));
    }

    void read_lut(StageRecipe& stage, const Table& table, const FormulaScope&) const {
        const Value& main = table.require("lut");
        const std::string named = Table::text_of(main, "lut");
        const std::string extension = extension_of(named);
        const Names& known = table_extensions();
        if (std::find(known.begin(), known.end(), extension) == known.end())
            fail(main.at,
                 "lut is " + described(main) + "; expected a file of " + join_choices(known));
        if (!tables_)
            fail(main.at, "lut is " + described(main) + "; this program reads no LUT as a stage");
        const std::filesystem::path path = std::filesystem::path(op_.file).parent_path() / named;
        TableFile lut;
        try {
            lut = tables_(path.string());
        } catch (const Error& e) {
            fail(main.at, e.text());
        }
        const Value* const input = table.find("input");
        if (!input && lut.encoding.empty()) {
            fail(main.at,
                 "the LUT does not say which encoding it expects; expected input = \"acescct\" or "
                 "another encoding of `tonewright bake`, or \"none\" for colors as they are");
        }
        const std::string encoding = table.text("input", lut.encoding);
        const std::string space = table.text("space", input ? "" : lut.space);
        try {
            stage.lut = {path.string(), encoding, space,
                         table_stages(lut, encoding, space, op_.working)};
        } catch (const Error& e) {
            fail(input ? input->at : main.at, e.text());
        }
    }

    void read_curve(StageRecipe& stage, const Table& table, const FormulaScope& scope) const {
        using Kind = StageRecipe::Kind;
        stage.f = one_or_three(*table.find("curve"), "curve", scope);
        const std::size_t apply =
            table.choice("apply", {"channels", "luminance", "max", "hue_preserving"});
        if (const Value* inverse = table.find("inverse")) {
            stage.inverse = one_or_three(*inverse, "inverse", scope);
            if (apply != 0)
                fail(inverse->at, "inverse is given with apply; expected it with channels only");
        }
        if (apply == 0) {
            if (const Value* weights = table.find("weights"))
                fail(weights->at, "weights are given without apply = \"luminance\"; expected both");
            return;
        }
        if (stage.f.size() != 1) {
            fail(table.find("curve")->at, "curve has three formulas; expected one with this apply");
        }
        stage.kind = apply == 3 ? Kind::hue_preserving : Kind::tone_scale;
        if (apply != 3) read_norm(stage, table, apply == 2);
    }

    void read_norm(StageRecipe& stage, const Table& table, bool is_max) const {
        stage.norm = is_max ? ToneScaleStage::Norm::max_rgb : ToneScaleStage::Norm::luminance;
        if (const Value* weights = table.find("weights")) {
            if (is_max)
                fail(weights->at, "weights are given with max; expected them with luminance");
            const auto& items = Table::items_of(*weights, "weights", 3);
            for (std::size_t i = 0; i < 3; ++i)
                stage.weights.at(i) = Table::number_of(items[i], "weights");
        } else if (!is_max) {
            stage.weights = rgb_to_xyz(op_.working)[1];
        }
        // A ratio of colors makes nothing of 0.
        const Expr black = 0;
        const Expr at_black = substitute(stage.f[0], std::span(&black, 1));
        constexpr double kZero = 1e-7;  // the rounding of a formula that is 0 at 0
        if (at_black.is_constant() && !(std::abs(at_black.value()) <= kZero)) {
            fail(stage.at, "formula is " + shortest(at_black.value()) +
                               " at black; expected 0 where it scales colors by their norm");
        }
    }

    // -- The rest

    void read_declarations(const Table& file) {
        if (const Value* all = file.find("deviation")) {
            if (all->kind != Value::Kind::array)
                fail(all->at, "deviation is " + described(*all) + "; expected [[deviation]]");
            for (const Value& item : all->items) {
                const Table table(item, "[[deviation]]", {"kind", "value", "when"});
                DocumentedDifference d{};
                d.kind = static_cast<DocumentedDifference::Kind>(
                    table.required_choice("kind", difference_names()));
                d.value = Table::number_of(table.require("value"), "value", true);
                d.when = table.text("when");
                op_.differences.push_back(d);
            }
        }
        if (const Value* value = file.find("bounds")) {
            DeclaredBounds& bounds = op_.bounds;
            const Table table(
                *value, "[bounds]",
                {"simd", "simd_goal", "ocio_cpu", "ocio_gpu", "cube", "cube_hdr", "reason"});
            const std::pair<const char*, double*> numbers[] = {
                {"simd", &bounds.simd},         {"simd_goal", &bounds.simd_goal},
                {"ocio_cpu", &bounds.ocio_cpu}, {"ocio_gpu", &bounds.ocio_gpu},
                {"cube", &bounds.lut3d},        {"cube_hdr", &bounds.lut3d_hdr}};
            for (const auto& [key, number] : numbers) {
                *number = table.number(key, *number);
                if (!(*number >= 0 && *number <= 1))
                    fail(table.find(key)->at,
                         std::string(key) + " is " + shortest(*number) + "; expected [0, 1]");
            }
            bounds.reason = line(table, "reason", "");
        }
    }

    void read_presets(const Table& file) {
        const Value* all = file.find("preset");
        if (!all) return;
        require_names(*all, "preset");
        for (const Value& member : all->members) {
            if (!is_id(member.key)) {
                fail(member.key_at, "preset is " + printable(member.key) +
                                        "; expected small letters, digits and _, a letter first");
            }
            const Table table(member, "[preset." + member.key + "]", {"title", "set"});
            Preset preset{member.key, line(table, "title", member.key), {}};
            const Value& settings = table.require("set");
            if (settings.kind != Value::Kind::table)
                fail(settings.at, "set is " + described(settings) + "; expected { NAME = value }");
            for (const Value& value : settings.members) {
                preset.settings[value.key] = value.kind == Value::Kind::text
                                                 ? value.text
                                                 : shortest(Table::number_of(value, value.key));
            }
            op_.presets.push_back(std::move(preset));
        }
    }

    void set_functions() {
        const std::shared_ptr<const OperatorRecipe> recipe = recipe_;
        op_.build = BuildRecipe{recipe};
        if (!recipe->inverse.empty())
            op_.build_inverse = BuildRecipe{recipe, &OperatorRecipe::inverse};
        if (!(recipe->output_primaries == op_.working)) {
            op_.output_primaries = [recipe](const Params&) { return recipe->output_primaries; };
        }
        if (recipe->peak) {
            op_.peak = [recipe](const Params& params) {
                return number_of(*recipe, *recipe->peak, params);
            };
        }
    }

    /// With the defaults, with each preset and with each look: what contradicts itself is an error
    /// of the file.
    void build_all(const Operator& op, const Value& root) const {
        const auto member = [&](const char* table, const std::string& key) {
            for (const Value& outer : root.members) {
                if (outer.key != table) continue;
                for (const Value& inner : outer.members) {
                    if (inner.key == key) return inner.key_at;
                }
            }
            return TextPosition{};
        };
        // resolve() makes one message of what build() throws; the place is kept beside it.
        std::optional<TextPosition> stage;
        Operator probe = op;
        probe.build = [&](const Params& params) {
            try {
                return op.build(params);
            } catch (const StageError& e) {
                stage = e.at;
                throw;
            }
        };
        const auto build = [&](const Preset* preset, const std::string& look, TextPosition at) {
            try {
                const ResolvedOperator resolved = resolve(probe, preset, {}, look);
                if (op.build_inverse) (void)op.build_inverse(resolved.params);
                const double peak = resolved.peak();
                if (!(peak > 0 && peak <= kHalfMax))
                    fail(at, "peak is " + shortest(peak) + "; expected (0, 65504]");
            } catch (const TomlError&) {
                throw;
            } catch (const StageError& e) {  // of the inverse
                fail(e.at, e.text());
            } catch (const Error& e) {
                fail(stage.value_or(at), e.text());
            }
        };
        build(nullptr, "", {});
        for (const Preset& preset : probe.presets)
            build(&preset, "", member("preset", preset.id));
        for (const Look& look : op.looks)
            build(nullptr, look.id, member("look", look.id));
    }

    std::string_view text_;
    const TableReader& tables_;
    Operator op_;
    std::shared_ptr<OperatorRecipe> recipe_ = std::make_shared<OperatorRecipe>();
    FormulaScope scope_;  // without inputs
};

}  // namespace

std::shared_ptr<const Operator> parse_operator(std::string_view text, const std::string& name,
                                               const TableReader& tables) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
        text.remove_prefix(kByteOrderMark.size());
    try {
        return Reader(text, name, tables).read();
    } catch (const TomlError& e) {
        throw DefinitionError(name + ":" + std::to_string(e.at.line) + ":" +
                                  std::to_string(e.at.column) + ": " + e.text(),
                              caret_lines(text, e.at));
    }
}

std::shared_ptr<const Operator> load_operator(const std::string& path, const TableReader& tables) {
    const std::vector<std::string>& known = table_extensions();
    if (std::find(known.begin(), known.end(), extension_of(path)) != known.end()) {
        if (!tables) throw FileError("read: " + path + ": is a LUT; expected a .tone file here");
        return with_memory_for(path, [&] { return operator_of_table(tables(path), path); });
    }
    const std::string text = read_file(path, kLongestFile, [&](const Problem& why) {
        throw FileError(within("read: " + path, why));
    });
    return with_memory_for(path, [&] { return parse_operator(text, path, tables); });
}

TONEWRIGHT_NAMESPACE_END
