// SPDX-License-Identifier: Apache-2.0
#include "cli/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

const Option& Option::required() const {
    option_->required();
    return *this;
}

const Option& Option::show_default() const {
    option_->capture_default_str();
    return *this;
}

const Option& Option::show_default(const std::string& text) const {
    option_->default_str(text);
    return *this;
}

const Option& Option::describe(const std::string& help) const {
    option_->description(help);
    return *this;
}

const Option& Option::group(const std::string& title) const {
    option_->group(title);
    return *this;
}

const Option& Option::range(int low, int high) const {
    option_->check(CLI::Range(low, high));
    return *this;
}

const Option& Option::range(double low, double high) const {
    option_->check(CLI::Range(low, high));
    return *this;
}

const Option& Option::choices(const std::vector<std::string>& texts) const {
    option_->check(CLI::IsMember(texts));
    return *this;
}

const Option& Option::choices(const std::vector<int>& numbers) const {
    option_->check(CLI::IsMember(numbers));
    return *this;
}

const Option& Option::one_value_each() const {
    option_->allow_extra_args(false);
    return *this;
}

const Option& Option::separated_by(char separator) const {
    option_->delimiter(separator);
    return *this;
}

const Option& Option::needs(const Option& other) const {
    option_->needs(other.option_);
    return *this;
}

const Option& Option::excludes(const Option& other) const {
    option_->excludes(other.option_);
    return *this;
}

Option Command::add(const std::string& name, std::string& value, const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

Option Command::add(const std::string& name, int& value, const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

Option Command::add(const std::string& name, double& value, const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

Option Command::add(const std::string& name, std::optional<int>& value,
                    const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

Option Command::add(const std::string& name, std::optional<double>& value,
                    const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

Option Command::add(const std::string& name, std::vector<std::string>& values,
                    const std::string& help) const {
    return Option(app_->add_option(name, values, help));
}

Option Command::add(const std::string& name, std::vector<double>& values,
                    const std::string& help) const {
    return Option(app_->add_option(name, values, help));
}

Option Command::add_flag(const std::string& name, bool& value, const std::string& help) const {
    return Option(app_->add_flag(name, value, help));
}

void Command::footer(const std::string& text) const { app_->footer(text); }

Option Command::option(const std::string& name) const { return Option(app_->get_option(name)); }

std::set<std::string> Command::given() const {
    std::set<std::string> names;
    for (const CLI::Option* option : app_->get_options()) {
        if (option->count() > 0) names.insert(option->get_name());
    }
    return names;
}

void Command::action(std::function<int()> run) const {
    app_->callback([run = std::move(run), exit_code = exit_code_] { *exit_code = run(); });
}

CommandLine::CommandLine(const std::string& name, const std::string& description,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
    app_->set_version_flag("--version", version);
    app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Command CommandLine::add(const std::string& name, const std::string& description) {
    return {app_->add_subcommand(name, description), &exit_code_};
}

void CommandLine::footer(const std::string& text) { app_->footer(text); }

int CommandLine::run(int argc, char** argv) {
    // CLI11 would only say that a subcommand is required.
    const std::vector<std::string> flags = {"-h", "--help", "--version"};
    const std::string first = argc > 1 ? argv[1] : flags[0];
    std::vector<std::string> names;
    for (const CLI::App* command : app_->get_subcommands([](CLI::App*) { return true; }))
        names.push_back(command->get_name());
    const auto is_in = [&](const std::vector<std::string>& list) {
        return std::find(list.begin(), list.end(), first) != list.end();
    };
    if (!is_in(names) && !is_in(flags)) {
        throw Error("command is " + first + "; expected " + join_choices(names) +
                    did_you_mean(first, names));
    }
    try {
        app_->parse(argc, argv);
    } catch (const CLI::Success& e) {
        return app_->exit(e);  // --help, --version
    } catch (const CLI::ParseError& e) {
        throw Error(e.what());
    }
    return exit_code_;
}

TONEWRIGHT_NAMESPACE_END
