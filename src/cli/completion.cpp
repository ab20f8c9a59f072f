// SPDX-License-Identifier: Apache-2.0
#include "cli/completion.h"

#include <algorithm>
#include <set>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool is_option(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

const OptionTable* find_option(const CommandTable& command, const std::string& name) {
    const auto found = std::find_if(
        command.options.begin(), command.options.end(), [&](const OptionTable& option) {
            const auto& names = option.names;
            return !option.is_argument &&
                   std::find(names.begin(), names.end(), name) != names.end();
        });
    return found == command.options.end() ? nullptr : &*found;
}

/// Files, if the option declares no suggestions and its value is a file.
Suggestions suggestions_for(const OptionTable& option, const TypedValue& typed) {
    if (option.suggest) return option.suggest(typed);
    Suggestions files;
    const std::set<std::string> names = {"FILE", "CONFIG", "OUT"};
    files.has_files = names.contains(option.value) || (option.is_argument && option.value.empty());
    files.has_folders = option.value == "FOLDER";
    return files;
}

/// `before` comes before the value in the same word: `--for=`.
Suggestions values_of(const OptionTable& option, TypedValue typed, std::string before) {
    if (option.separator != 0) {
        const std::size_t end = typed.text.rfind(option.separator) + 1;  // npos + 1 is 0
        before += typed.text.substr(0, end);
        typed.text.erase(0, end);
    }
    Suggestions all = suggestions_for(option, typed);
    std::erase_if(all.words, [&](const Suggestion& s) { return !s.word.starts_with(typed.text); });
    for (Suggestion& suggestion : all.words)
        suggestion.word.insert(0, before);
    return all;
}

/// The options and arguments of the words before the last one, and the kind of the last one.
class TypedCommand {
  public:
    TypedCommand(const CommandTable& command, const std::vector<std::string>& words)
        : command_(command) {
        for (const OptionTable& option : command.options) {
            if (option.is_argument) arguments_.push_back(&option);
        }
        for (const std::string& word : words)
            take(word);
    }

    [[nodiscard]] Suggestions complete(const std::string& word) const {
        if (pending_) return values_of(*pending_, {word, values_}, "");
        if (are_options_over_ || !is_option(word)) {
            if (const OptionTable* argument = next_argument(); argument && word != "-")
                return values_of(*argument, {word, values_}, "");
        }
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos) return names_of_options(word);
        const OptionTable* option = find_option(command_, word.substr(0, equals));
        if (!option || !option->has_value) return {};
        return values_of(*option, {word.substr(equals + 1), values_}, word.substr(0, equals + 1));
    }

  private:
    void take(const std::string& word) {
        if (pending_) {
            values_[pending_->names.front()].push_back(word);
            pending_ = nullptr;
        } else if (are_options_over_ || !is_option(word)) {
            if (const OptionTable* argument = next_argument()) {
                values_[argument->names.front()].push_back(word);
                ++argument_count_;
            }
        } else if (word == "--") {
            are_options_over_ = true;
        } else {
            const std::size_t equals = word.find('=');
            const OptionTable* option = find_option(command_, word.substr(0, equals));
            if (!option) return;
            std::vector<std::string>& values = values_[option->names.front()];
            if (equals != std::string::npos) {
                values.push_back(word.substr(equals + 1));
            } else if (option->has_value) {
                pending_ = option;
            }
        }
    }

    /// Null: all are given.
    [[nodiscard]] const OptionTable* next_argument() const {
        if (argument_count_ < arguments_.size()) return arguments_[argument_count_];
        return !arguments_.empty() && arguments_.back()->may_repeat ? arguments_.back() : nullptr;
    }

    [[nodiscard]] Suggestions names_of_options(const std::string& word) const {
        Suggestions all;
        for (const OptionTable& option : command_.options) {
            if (option.is_argument) continue;
            if (values_.contains(option.names.front()) && !option.may_repeat) continue;
            for (const std::string& name : option.names) {
                if (name.starts_with(word)) all.words.push_back({name, option.text});
            }
        }
        return all;
    }

    const CommandTable& command_;
    std::vector<const OptionTable*> arguments_;
    std::map<std::string, std::vector<std::string>> values_;
    std::size_t argument_count_ = 0;
    const OptionTable* pending_ = nullptr;
    bool are_options_over_ = false;
};

}  // namespace

Suggest one_of(std::vector<std::string> words) {
    return [words = std::move(words)](const TypedValue&) {
        Suggestions all;
        for (const std::string& word : words)
            all.words.push_back({word, ""});
        return all;
    };
}

Suggestions complete(const std::vector<CommandTable>& tables,
                     const std::vector<std::string>& words) {
    const CommandTable& program = tables.front();
    const std::string word = words.empty() ? "" : words.back();
    const bool is_help = words.size() == 2 && words.front() == "help";
    if (words.size() > 1 && !is_help) {
        const auto found = std::find_if(tables.begin() + 1, tables.end(),
                                        [&](const auto& t) { return t.name == words.front(); });
        if (found == tables.end()) return {};
        return TypedCommand(*found, {words.begin() + 1, words.end() - 1}).complete(word);
    }
    if (is_option(word)) return TypedCommand(program, {}).complete(word);
    Suggestions commands;
    for (auto table = tables.begin() + 1; table != tables.end(); ++table) {
        if (table->name.starts_with(word))
            commands.words.push_back({table->name, table->page.description});
    }
    return commands;
}

std::string to_text(const Suggestions& suggestions) {
    std::string text;
    for (const auto& [word, meaning] : suggestions.words) {
        text += word;
        if (!meaning.empty()) text.append("\t").append(meaning);
        text += '\n';
    }
    if (suggestions.has_files) text += ":files\n";
    if (suggestions.has_folders) text += ":folders\n";
    return text;
}

TONEWRIGHT_NAMESPACE_END
