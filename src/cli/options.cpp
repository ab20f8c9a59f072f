// SPDX-License-Identifier: Apache-2.0
#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <type_traits>

#include "base/strings.h"
#include "cli/help_text.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kGeneralOptions = "General options";

template <class Value>
constexpr bool kIsText =
    std::is_same_v<Value, std::string> || std::is_same_v<Value, std::vector<std::string>>;
template <class Value>
using NumberOf =
    std::conditional_t<std::is_same_v<Value, int> || std::is_same_v<Value, std::optional<int>>, int,
                       double>;

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string argument_name(const CLI::Option& option) {
    std::string name = option.get_single_name();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name;
}

/// `IN`, or `IN...` for several.
std::string argument_usage(const CLI::Option& option) {
    return argument_name(option) + (option.get_items_expected_max() > 1 ? "..." : "");
}

/// Name in messages: `--size`, or `OPERATOR` for an argument.
std::string name_of(const CLI::Option& option) {
    return option.get_positional() ? argument_name(option) : option.get_name();
}

/// `apply: --size`, which begins every message about the option.
std::string subject_of(const CLI::App& command, const CLI::Option& option) {
    return fmt::format("{}: {}", command.get_name(), name_of(option));
}

/// The text of a number, in decimal notation.
/// @throws Error
template <class Number>
std::string checked_number(const std::string& subject, const std::string& text,
                           const std::optional<std::pair<double, double>>& limits) {
    constexpr bool kIsWhole = std::is_integral_v<Number>;
    Number number{};
    const char* end = text.data() + text.size();
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [last, error] = std::from_chars(begin, end, number);
    bool is_good = error == std::errc() && last == end;
    if constexpr (!kIsWhole) is_good = is_good && std::isfinite(number);
    if (is_good && limits)
        is_good = static_cast<double>(number) >= limits->first &&
                  static_cast<double>(number) <= limits->second;
    if (is_good) return fmt::format("{}", number);
    std::string expected = kIsWhole ? "a whole number" : "a number";
    if (limits) {
        expected += fmt::format(" in [{}, {}]", limits->first, limits->second);
    } else if (kIsWhole && error == std::errc::result_out_of_range) {
        expected += fmt::format(" in [{}, {}]", std::numeric_limits<Number>::min(),
                                std::numeric_limits<Number>::max());
    }
    throw Error(
        fmt::format("{} is {}; expected {}", subject, text.empty() ? "empty" : text, expected));
}

/// The text to type: `--size N`, `--exact`.
std::string usage_of(const CLI::Option& option) {
    if (option.get_positional() || option.get_items_expected_max() == 0) return name_of(option);
    return name_of(option) + " " + option.get_type_name();
}

/// Beginning of messages about a given option: `apply: --size is 3`, `apply: --exact is given`.
std::string given_of(const CLI::App& command, const CLI::Option& option) {
    std::string text = subject_of(command, option) + " is ";
    if (option.get_items_expected_max() == 0) return text + "given";
    text += option.results().empty() ? "" : option.results().front();
    return text;
}

Error missing_value(const CLI::App& command, const CLI::Option& option) {
    return Error(
        fmt::format("{} has no value; expected {}", subject_of(command, option), usage_of(option)));
}

bool is_option(const CLI::App& command, const std::string& text) {
    return text.size() > 1 && text.front() == '-' && command.get_option_no_throw(text) != nullptr;
}

/// Makes a number a plain decimal. Throws an Error if the text is no value of the option.
template <class Value>
void check_value(const CLI::App& app, const CLI::Option& option,
                 const std::optional<std::pair<double, double>>& range, std::string& text) {
    // CLI11 takes the next word as the value, even an option.
    if (!option.get_positional() && is_option(app, text)) throw missing_value(app, option);
    if constexpr (!kIsText<Value>)
        text = checked_number<NumberOf<Value>>(subject_of(app, option), text, range);
}

/// CLI11's commands as help pages.
class HelpFormatter : public CLI::FormatterBase {
  public:
    explicit HelpFormatter(const FactsByOption& facts) : facts_(facts) {}

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        const bool has_all = mode != CLI::AppFormatMode::Normal;
        std::string help = format_help(page_of(*app, name), has_all, help_width());
        if (!has_all) return help;
        for (const CLI::App* command : subcommands(*app)) {
            help += "\n\n";
            help += make_help(command, name + " " + command->get_name(), mode);
        }
        return help;
    }

    [[nodiscard]] HelpPage page_of(const CLI::App& app, const std::string& name) const;
    [[nodiscard]] OptionFacts facts_of(const CLI::Option& option) const {
        const auto found = facts_.find(&option);
        return found == facts_.end() ? OptionFacts() : found->second;
    }

  private:
    [[nodiscard]] HelpEntry entry_of(const CLI::Option& option) const;

    const FactsByOption& facts_;
};

HelpGroup& group_named(std::vector<HelpGroup>& groups, const std::string& title) {
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const HelpGroup& group) { return group.title == title; });
    if (found != groups.end()) return *found;
    groups.push_back({title, {}});
    return groups.back();
}

HelpEntry HelpFormatter::entry_of(const CLI::Option& option) const {
    const OptionFacts known = facts_of(option);
    HelpEntry entry;
    entry.is_common = known.is_common;
    if (option.get_positional()) {
        entry.names = argument_usage(option);
    } else {
        for (const std::string& name : option.get_snames())
            entry.names += (entry.names.empty() ? "-" : ", -") + name;
        for (const std::string& name : option.get_lnames())
            entry.names += (entry.names.empty() ? "--" : ", --") + name;
        if (option.get_items_expected_max() > 0) entry.names += " " + option.get_type_name();
    }
    entry.text = option.get_description();
    std::string facts = option.get_default_str();
    if (!facts.empty()) facts.insert(0, "default ");
    constexpr double kMostShown = 1 << 16;  // a limit that no user reaches does not help
    if (known.range && known.range->second < kMostShown) {
        facts += fmt::format("{}{}..{}", facts.empty() ? "" : "; ", known.range->first,
                             known.range->second);
    }
    if (facts.empty()) return entry;
    // After a default that is in the text.
    if (entry.text.ends_with(')') && entry.text.find(" (default") != std::string::npos) {
        entry.text.back() = ';';
        entry.text += " " + facts + ")";
    } else {
        entry.text += " (" + facts + ")";
    }
    return entry;
}

HelpPage HelpFormatter::page_of(const CLI::App& app, const std::string& name) const {
    HelpPage page;
    page.description = app.get_description();
    page.footer = app.get_footer();
    page.usage = name;
    std::vector<const CLI::Option*> options = app.get_options();
    for (const CLI::App* command : subcommands(app))
        group_named(page.groups, command->get_group())
            .entries.push_back({command->get_name(), command->get_description()});
    page.usage += page.groups.empty() ? " [OPTIONS]" : " COMMAND [OPTIONS]";
    bool has_common = false;
    std::size_t number = 0;
    for (const CLI::Option* option : options) {
        has_common = has_common || facts_of(*option).is_common;
        if (!option->get_positional()) {
            ++number;
            continue;
        }
        const std::string argument = argument_usage(*option);
        page.usage += option->get_required() ? " " + argument : " [" + argument + "]";
    }
    // Options of all commands come last.
    const auto is_general = [](const CLI::Option* option) {
        return option->get_group() == kGeneralOptions;
    };
    std::stable_partition(options.begin(), options.end(),
                          [&](const CLI::Option* option) { return !is_general(option); });
    for (const CLI::Option* option : options) {
        const std::string title = option->get_positional() ? "Arguments" : option->get_group();
        HelpEntry entry = entry_of(*option);
        if (option == app.get_help_all_ptr() && has_common)
            entry.text = fmt::format("print all {} options", number);
        if (!has_common || option->get_positional() || is_general(option)) entry.is_common = true;
        group_named(page.groups, title).entries.push_back(std::move(entry));
    }
    return page;
}

}  // namespace

void Command::title(const std::string& text) const { app_->option_defaults()->group(text); }

/// Values are checked here, with Tonewright's messages, before CLI11 converts them with its own.
void Command::add(const std::string& names, const std::string& value, OptionVariable variable,
                  const std::string& help, const OptionFacts& facts) const {
    const auto add_to = [&]<class Value>(Value* target) {
        CLI::Option* option = app_->add_option(names, *target, help);
        const auto check = [app = app_, option, range = facts.range](std::string& text) {
            check_value<Value>(*app, *option, range, text);
            return std::string();
        };
        option->transform(CLI::Validator(check, {}));
        option->type_name(value);
        if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
            if (help.find("(default") == std::string::npos) option->capture_default_str();
        }
        set(option, facts);
    };
    std::visit(add_to, variable);
}

void Command::argument(const std::string& name, OptionVariable variable, const std::string& help,
                       const OptionFacts& facts) const {
    add(name, "", variable, help, facts);
}

void Command::add_flag(const std::string& names, bool* variable, const std::string& help,
                       const OptionFacts& facts) const {
    CLI::Option* option = app_->add_flag(names, *variable, help);
    const auto check = [app = app_, option](std::string& text) {
        if (text == "true") return std::string();
        throw Error(fmt::format("{} is {}; expected no value", subject_of(*app, *option), text));
    };
    option->transform(CLI::Validator(check, {}));
    option->type_name("");
    set(option, facts);
}

void Command::set(CLI::Option* option, const OptionFacts& facts) const {
    OptionFacts& known = (*facts_)[option] = facts;
    if (!facts.choices.empty()) {
        const auto as_listed = [app = app_, option, texts = facts.choices](std::string& text) {
            text = texts[find_choice(name_of(*option), text, texts, app->get_name())];
            return std::string();
        };
        option->transform(CLI::Validator(as_listed, {}));
        known.suggest = one_of(facts.choices);
    }
    if (!facts.default_text.empty()) option->default_str(facts.default_text);
    if (facts.is_required) option->required();
    if (facts.takes_one_each) option->allow_extra_args(false);
    if (facts.separator != 0) option->delimiter(facts.separator);
    for (const std::string& other : facts.needs)
        option->needs(app_->get_option(other));
    for (const std::string& other : facts.excludes)
        option->excludes(app_->get_option(other));
}

void Command::describe(const std::string& name, const std::string& help, Suggest suggest) const {
    CLI::Option* option = app_->get_option(name);
    option->description(help);
    if (suggest) (*facts_)[option].suggest = std::move(suggest);
}

void Command::exclude(const std::string& name, const std::vector<std::string>& others) const {
    for (const std::string& other : others)
        app_->get_option(name)->excludes(app_->get_option(other));
}

void Command::common(const std::vector<std::string>& names) const {
    for (const std::string& name : names)
        (*facts_)[app_->get_option(name)].is_common = true;
}

void Command::footer(const std::string& text) const { app_->footer(text); }

void Command::action(std::function<int()> run, std::set<std::string>* given) const {
    app_->callback([run = std::move(run), given, exit_code = exit_code_, app = app_] {
        MessageOptions& messages = message_options();
        messages.command = app->get_name();
        for (const CLI::Option* option : app->get_options()) {
            for (const std::string& name : option->get_lnames())
                messages.options.insert("--" + name);
            if (given && option->count() > 0) given->insert(option->get_name());
        }
        *exit_code = run();
        if (*exit_code == 0) finish_progress();
    });
}

CommandLine::CommandLine(const std::string& name, const std::string& description,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
    app_->formatter(std::make_shared<HelpFormatter>(facts_));
    app_->option_defaults()->group(kGeneralOptions);
    app_->set_help_flag("-h,--help", "print the common options");
    app_->set_help_all_flag("--help-all", "print all options");
    app_->set_version_flag("--version", version, "print the version");
    app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Command CommandLine::add(const std::string& name, const std::string& group,
                         const std::string& description) {
    CLI::App* app = app_->add_subcommand(name, description)->group(group);
    for (const char* help : {"--help", "--help-all"})  // made before the defaults are inherited
        app->get_option(help)->group(kGeneralOptions);
    Command command(app, &exit_code_, &facts_);
    MessageOptions& messages = message_options();
    command.add_flag("--strict", &messages.is_strict, "treat warnings as errors (exit code 1)");
    command.add_flag("-q,--quiet", &messages.is_quiet, "print errors and warnings only");
    command.add_flag("-v,--verbose", &messages.is_verbose, "print more details");
    command.title("Options");  // not a general one from here on
    return command;
}

void CommandLine::footer(const std::string& text) { app_->footer(text); }

std::vector<CommandTable> CommandLine::tables() const {
    const HelpFormatter formatter(facts_);
    std::vector<const CLI::App*> apps = subcommands(*app_);
    apps.insert(apps.begin(), app_.get());
    std::vector<CommandTable> tables;
    for (const CLI::App* app : apps) {
        CommandTable& table = tables.emplace_back();
        table.name = app->get_name();
        const std::string prefix = app == app_.get() ? "" : app_->get_name() + " ";
        table.page = formatter.page_of(*app, prefix + table.name);
        for (const CLI::Option* option : app->get_options()) {
            OptionTable& row = table.options.emplace_back();
            row.is_argument = option->get_positional();
            for (const std::string& name : option->get_lnames())
                row.names.push_back("--" + name);
            for (const std::string& name : option->get_snames())
                row.names.push_back("-" + name);
            if (row.is_argument) row.names = {argument_name(*option)};
            row.text = option->get_description();
            row.has_value = option->get_items_expected_max() > 0;
            row.may_repeat = option->get_items_expected_max() > 1;
            row.separator = option->get_delimiter();
            if (row.has_value) row.value = option->get_type_name();
            row.suggest = formatter.facts_of(*option).suggest;
        }
    }
    return tables;
}

namespace {

/// The command that prints all options.
std::string help_command(const CLI::App& command) {
    const CLI::App* const program = command.get_parent();
    const std::string prefix = program ? program->get_name() + " " : "";
    return fmt::format("`{}{} --help-all`", prefix, command.get_name());
}

/// Options that people know from oiiotool, ffmpeg and ImageMagick or from earlier builds, and what
/// does that job here.
std::string hint_of(std::string_view typed) {
    struct Hint {
        std::string_view options;
        std::string_view text;
    };
    // `-f` is what is left of ffmpeg's -vf.
    static constexpr Hint kHints[] = {
        {" --gamma -gamma ",
         "the display's curve is --display g22, or another one that `tonewright list` shows"},
        {" --colorspace -colorspace --colorconvert ", "use --input SPACE and --display NAME"},
        {" --tocolorspace ", "use --display NAME"},
        {" --iscolorspace ", "use --input SPACE"},
        {" --ociodisplay ", "use --operator NAME and --display NAME"},
        {" --channels --ch ", "use --layer NAME, or oiiotool --ch R,G,B before"},
        {" --autoorient -auto-orient ", "pictures are turned by their orientation anyway"},
        {" --resize ", "only `apply` and `compare` resize, before the operator"},
        {" -resize ", "use `tonewright apply --resize SIZE`"},
        {" --crop ", "use oiiotool --crop before"},
        {" --cdl ", "an ASC CDL is a LUT: use --lut FILE.cdl or .cc, or a .tone file"},
        {" --mulc ", "use --exposure STOPS"},
        {" --powc ", "use a .tone file"},
        {" --unpremultiply ", "use --unpremult"},
        {" --flatten --over -flatten -background ", "use --alpha over:R,G,B"},
        {" -alpha ", "use --alpha keep, ignore, opaque or over:R,G,B"},
        {" -depth -pix_fmt ", "use -d uint8 or uint16"},
        {" -bitdepth ", "use -d uint8, uint10, uint12 or uint16"},
        {" -quality ", "use --quality N"},
        {" -sampling-factor ", "use --subsampling 4:4:4"},
        {" -f ", "filters of ffmpeg take a LUT: use `tonewright bake --for ffmpeg`"},
        {" -i ", "the input is the first argument"},
        {" -y ", "an existing output is replaced anyway"},
        {" -n ", "use --skip-existing with --frames"},
        {" --catalogue ", "use build/release/bin/tonewright_tools catalogue -o FOLDER"},
        {" --npm ", "use build/release/bin/tonewright_tools npm -o FOLDER"},
        {" manual ", "use build/release/bin/tonewright_tools manual -o FOLDER"},
        {" --saturation --contrast ",
         "use --set, or a .tone file; `tonewright list OPERATOR` shows parameters"},
    };
    const auto* const end = std::end(kHints);
    const std::string word = fmt::format(" {} ", typed);
    const auto* const found = std::find_if(std::begin(kHints), end, [&](const Hint& hint) {
        return hint.options.find(word) != std::string_view::npos;
    });
    return found == end ? std::string() : fmt::format("; {}", found->text);
}

/// An option that the command does not have.
std::optional<std::string> unknown_option(const CLI::App& command) {
    const std::vector<std::string> extras = command.remaining();
    const auto option = std::find_if(extras.begin(), extras.end(), [](const std::string& text) {
        return text.size() > 1 && text.front() == '-';
    });
    if (option == extras.end()) return {};
    std::vector<std::string> known;
    for (const CLI::Option* other : command.get_options()) {
        for (const std::string& text : other->get_lnames())
            known.push_back("--" + text);
    }
    const std::string typed = option->substr(0, option->find('='));
    const std::string hint = hint_of(typed);
    return fmt::format("{}: there is no option {}; {} lists all{}", command.get_name(), typed,
                       help_command(command), hint.empty() ? did_you_mean(typed, known) : hint);
}

/// An option or argument that is missing, or that excludes another.
std::optional<std::string> unmet_requirement(const CLI::App& command) {
    const std::vector<const CLI::Option*> options = command.get_options();
    const auto contains = [](const std::set<CLI::Option*>& list, const CLI::Option* option) {
        return std::any_of(list.begin(), list.end(),
                           [&](const CLI::Option* other) { return other == option; });
    };
    for (const CLI::Option* option : options) {
        if (option->get_required() && option->count() == 0) {
            return fmt::format(
                "{} is missing; expected {}", subject_of(command, *option),
                option->get_positional() ? option->get_description() : usage_of(*option));
        }
        if (option->count() == 0) continue;
        std::vector<std::string> needed;  // in the order of the help
        for (const CLI::Option* other : options) {
            const bool is_given = other->count() > 0;
            if (is_given && contains(option->get_excludes(), other)) {
                return fmt::format("{}: {} and {} are given; expected one of them",
                                   command.get_name(), name_of(*option), name_of(*other));
            }
            if (!is_given && contains(option->get_needs(), other))
                needed.push_back(usage_of(*other));
        }
        if (!needed.empty()) {
            return fmt::format("{}; expected {} with it", given_of(command, *option),
                               fmt::join(needed, " and "));
        }
    }
    return {};
}

/// An option of one value that has two.
std::optional<std::string> repeated_option(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        const std::vector<std::string>& values = option->results();
        const auto most = static_cast<std::size_t>(option->get_items_expected_max());
        if (most == 0 || values.size() <= most) continue;
        return fmt::format("{} is {} and {}; expected it once", subject_of(command, *option),
                           values[0], values[1]);
    }
    return {};
}

/// An argument that no option takes.
std::optional<std::string> unexpected_argument(const CLI::App& command) {
    const std::vector<std::string> extras = command.remaining();
    if (extras.empty()) return {};
    std::vector<std::string> arguments;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional()) arguments.push_back(argument_usage(*option));
    }
    return fmt::format(
        "{}: argument is {}; expected {} only", command.get_name(), extras.front(),
        arguments.empty() ? "options" : fmt::format("one {}", fmt::join(arguments, " ")));
}

/// The error of a command line that CLI11 refuses, in our words. It follows from the state of the
/// options, because CLI11's exceptions contain finished sentences only.
/// @param last_word  of the command line
Error usage_error(const CLI::App& command, const std::string& last_word,
                  const CLI::ParseError& error) {
    // CLI11 runs out of words when a value is missing.
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
        const std::string name = last_word.substr(0, last_word.find('='));
        if (const auto text = repeated_option(command)) return Error(*text);
        if (const CLI::Option* option = command.get_option_no_throw(name))
            return missing_value(command, *option);
    }
    for (const std::optional<std::string>& text :
         {unknown_option(command), unmet_requirement(command), repeated_option(command),
          unexpected_argument(command)}) {
        if (text) return Error(*text);
    }
    return Error(fmt::format("{}: {}", command.get_name(), error.what()));
}

}  // namespace

int CommandLine::run(int argc, char** argv) {
    // `help COMMAND` is `COMMAND --help`.
    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") {
        if (words.size() > 2)
            throw Error("help: argument is " + words[2] + "; expected one command");
        words.erase(words.begin());
        words.emplace_back("--help");
    }
    std::vector<std::string> names;
    for (const CLI::App* command : subcommands(*app_))
        names.push_back(command->get_name());
    names.emplace_back("help");
    if (words.empty()) throw Error("command is missing; expected " + join_choices(names));
    const std::string first = words.front();
    const std::vector<std::string> flags = {"-h", "--help", "--help-all", "--version"};
    const auto is_in = [&](const std::vector<std::string>& list) {
        return std::find(list.begin(), list.end(), first) != list.end();
    };
    if (!is_in(names) && !is_in(flags)) {
        const std::string hint = hint_of(first);
        throw Error("command is " + first + "; expected " + join_choices(names) +
                    (hint.empty() ? did_you_mean(first, names) : hint));
    }
    const std::string last = words.back();
    try {
        std::reverse(words.begin(), words.end());  // in CLI11's order
        app_->parse(std::move(words));
    } catch (const CLI::Success& e) {
        return app_->exit(e);  // --help, --version
    } catch (const CLI::ParseError& e) {
        const std::vector<CLI::App*> commands = app_->get_subcommands();
        throw usage_error(commands.empty() ? *app_ : *commands.front(), last, e);
    }
    return exit_code_;
}

TONEWRIGHT_NAMESPACE_END
