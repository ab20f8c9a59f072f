// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap_arguments.h"
#include "base/strings.h"
#include "tonewright/tonemap.h"

#include <algorithm>
#include <charconv>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kParameter = "set.";

double parse_number(std::string_view name, const std::string& value) {
    double number = 0;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, number);
    if (error != std::errc() || stop != end)
        throw Error({.parameter = std::string(name), .value = value, .expected = "a number"});
    return number;
}

template <class Choice>
Choice parse_choice(std::string_view name, const std::string& value,
                    const std::vector<std::pair<std::string, Choice>>& choices) {
    std::vector<std::string> names;
    names.reserve(choices.size());
    for (const auto& choice : choices)
        names.push_back(choice.first);
    return choices[find_choice(name, value, names)].second;
}

}  // namespace

const std::vector<std::string>& tonemap_argument_names() {
    static const std::vector<std::string> names = {
        "op",        "look",       "exposure", "input", "display", "input_units", "reference_white",
        "unpremult", "statistics", "mix"};
    return names;
}

bool is_tonemap_argument(std::string_view name) {
    const std::vector<std::string>& names = tonemap_argument_names();
    return std::find(names.begin(), names.end(), name) != names.end() ||
           (name.starts_with(kParameter) && name.size() > kParameter.size());
}

std::string tonemap_argument_choices() {
    std::vector<std::string> choices = tonemap_argument_names();
    choices.emplace_back("set.NAME for a parameter of the operator");
    return join_choices(choices);
}

TonemapOptions resolve_arguments(const TonemapArguments& arguments, const OperatorSet& operators) {
    TonemapOptions options = arguments.others;
    options.op =
        resolve_picture_operator(arguments.op, arguments.settings, arguments.look, operators);
    return options;
}

void set_tonemap_argument(TonemapArguments& arguments, std::string_view name,
                          const std::string& value) {
    TonemapOptions& options = arguments.others;
    using Unpremult = TonemapOptions::Unpremult;
    using Statistics = TonemapOptions::Statistics;
    if (name == "op") {
        arguments.op = value;
    } else if (name == "look") {
        arguments.look = value;
    } else if (name == "exposure") {
        options.exposure_stops = parse_number(name, value);
    } else if (name == "input") {
        options.input = value;
    } else if (name == "display") {
        options.display = value;
    } else if (name == "reference_white") {
        options.reference_white = parse_number(name, value);
    } else if (name == "input_units") {
        options.input_units = parse_input_units(value);
    } else if (name == "mix") {
        options.mix = parse_number(name, value);
    } else if (name == "unpremult") {
        options.unpremult = parse_choice<Unpremult>(
            name, value,
            {{"auto", Unpremult::automatic}, {"yes", Unpremult::yes}, {"no", Unpremult::no}});
    } else if (name == "statistics") {
        options.statistics = parse_choice<Statistics>(
            name, value,
            {{"picture", Statistics::from_picture}, {"defaults", Statistics::defaults}});
    } else if (name.starts_with(kParameter) && name.size() > kParameter.size()) {
        arguments.settings[std::string(name.substr(kParameter.size()))] = value;
    } else {
        throw Error("argument is " + std::string(name) + "; expected " +
                    tonemap_argument_choices() + did_you_mean(name, tonemap_argument_names()));
    }
}

TONEWRIGHT_NAMESPACE_END
