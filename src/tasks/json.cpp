// SPDX-License-Identifier: Apache-2.0
#include "tasks/json.h"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Library = nlohmann::ordered_json;

/// Levels of a text that parse() takes: from_library() calls itself for each.
constexpr int kDeepest = 100;

/// JSON is UTF-8, and names of files are bytes.
Library to_library(const Json& json) {
    return std::visit(
        [](const auto& value) -> Library {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, Json::Array>) {
                Library array = Library::array();
                for (const Json& element : value)
                    array.push_back(to_library(element));
                return array;
            } else if constexpr (std::is_same_v<T, Json::Object>) {
                Library object = Library::object();
                for (const auto& [name, member] : value)
                    object.emplace(utf8_text(name), to_library(member));
                return object;
            } else if constexpr (std::is_same_v<T, std::string>) {
                return utf8_text(value);
            } else {
                return value;
            }
        },
        json.value());
}

Json from_library(const Library& library) {
    switch (library.type()) {
        case Library::value_t::boolean:
            return library.get<bool>();
        // Written Json(int64) is read as uint64 if it is not negative.
        case Library::value_t::number_integer:
            return library.get<std::int64_t>();
        case Library::value_t::number_unsigned:
            return library.get<std::uint64_t>();
        case Library::value_t::number_float:
            return library.get<double>();
        case Library::value_t::string:
            return library.get<std::string>();
        case Library::value_t::array: {
            Json array = Json::array();
            for (const Library& element : library)
                array.push_back(from_library(element));
            return array;
        }
        case Library::value_t::object: {
            Json object = Json::object();
            for (const auto& [name, member] : library.items())
                object.add(name, from_library(member));
            return object;
        }
        default:
            return nullptr;
    }
}

template <class T>
const T& as(const Json& json, const char* expected) {
    const T* value = std::get_if<T>(&json.value());
    if (!value) throw JsonError(std::string("expected ") + expected);
    return *value;
}

template <class T>
T number_of(const Json& json) {
    return std::visit(
        [](const auto& value) -> T {
            using Held = std::decay_t<decltype(value)>;
            constexpr bool is_whole = std::is_integral_v<Held> && !std::is_same_v<Held, bool>;
            if constexpr (std::is_same_v<T, double> && (is_whole || std::is_same_v<Held, double>)) {
                return static_cast<double>(value);
            } else if constexpr (is_whole) {
                if (std::in_range<T>(value)) return static_cast<T>(value);
            }
            throw JsonError("expected a number");
        },
        json.value());
}

}  // namespace

Json::Json() = default;
Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;
Json::Json(std::nullptr_t) {}
Json::Json(bool value) : value_(value) {}
Json::Json(int value) : value_(std::int64_t{value}) {}
Json::Json(std::int64_t value) : value_(value) {}
Json::Json(std::uint64_t value) : value_(value) {}
Json::Json(double value) : value_(value) {}
Json::Json(std::string value) : value_(std::move(value)) {}
Json::Json(std::string_view value) : value_(std::string(value)) {}
Json::Json(const char* value) : value_(std::string(value)) {}
Json::Json(std::initializer_list<Member> members) : value_(Object(members)) {}

Json Json::array(std::initializer_list<Json> values) {
    Json json;
    json.value_ = Array(values);
    return json;
}

Json Json::object() {
    Json json;
    json.value_ = Object();
    return json;
}

void Json::push_back(Json value) {
    if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Array();
    std::get<Array>(value_).push_back(std::move(value));
}

void Json::add(std::string name, Json value) {
    if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Object();
    std::get<Object>(value_).emplace_back(std::move(name), std::move(value));
}

const Json& Json::at(std::string_view name) const {
    for (const Member& member : members()) {
        if (member.first == name) return member.second;
    }
    throw JsonError("there is no member " + std::string(name));
}

const Json::Object& Json::members() const { return as<Object>(*this, "an object"); }

const Json::Array& Json::elements() const { return as<Array>(*this, "an array"); }

void Json::get_to(std::int64_t& to) const { to = number_of<std::int64_t>(*this); }

void Json::get_to(std::uint64_t& to) const { to = number_of<std::uint64_t>(*this); }

void Json::get_to(double& to) const { to = number_of<double>(*this); }

std::string Json::dump(int indent) const { return to_library(*this).dump(indent); }

Json Json::parse(const std::string& text) {
    try {
        return from_library(Library::parse(text, [](int depth, auto, const auto&) {
            if (depth > kDeepest) throw JsonError("too deep");
            return true;
        }));
    } catch (const Library::exception& e) {
        throw JsonError(e.what());
    }
}

TONEWRIGHT_NAMESPACE_END
