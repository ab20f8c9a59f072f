// SPDX-License-Identifier: Apache-2.0
//
// A JSON value. Only json.cpp includes nlohmann/json.hpp, which takes seconds to compile.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Thrown by Json::parse() for text that is not JSON, and by the readers of Json for a value of
/// another kind.
class JsonError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A JSON value. Objects keep the order in which members were added.
class Json {
  public:
    using Array = std::vector<Json>;
    using Member = std::pair<std::string, Json>;
    using Object = std::vector<Member>;

    // Defined in json.cpp, because inlined into every table they are slow to compile.
    Json();  // null
    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(const Json& other);
    Json& operator=(Json&& other) noexcept;
    ~Json();
    Json(std::nullptr_t);
    Json(bool value);
    Json(int value);
    Json(std::int64_t value);
    Json(std::uint64_t value);
    Json(double value);
    Json(std::string value);
    Json(std::string_view value);
    Json(const char* value);
    Json(std::initializer_list<Member> members);  // an object: {{"id", id}, {"title", title}}
    template <class T>
    Json(const std::vector<T>& values) : value_(Array(values.begin(), values.end())) {}
    template <class T, std::size_t N>
    Json(const std::array<T, N>& values) : value_(Array(values.begin(), values.end())) {}
    /// The value, or null.
    template <class T>
    Json(const std::optional<T>& value) {
        if (value) *this = Json(*value);
    }
    template <class T>
    Json(const std::map<std::string, T>& members)
        : value_(Object(members.begin(), members.end())) {}
    [[nodiscard]] static Json array(std::initializer_list<Json> values = {});
    [[nodiscard]] static Json object();

    /// Appends to an array; null becomes one.
    void push_back(Json value);
    /// Appends a member to an object, which has no member of this name yet; null becomes an object.
    void add(std::string name, Json value);

    /// @throws JsonError  the value is of another kind, or there is no such member
    [[nodiscard]] const Json& at(std::string_view name) const;
    [[nodiscard]] const Object& members() const;
    void get_to(std::int64_t& to) const;
    void get_to(std::uint64_t& to) const;
    void get_to(double& to) const;
    template <class T>
    void get_to(std::vector<T>& to) const {
        to.clear();
        for (const Json& value : elements())
            value.get_to(to.emplace_back());
    }
    template <class T, std::size_t N>
    void get_to(std::array<T, N>& to) const {
        if (elements().size() != N) throw JsonError("another number of elements");
        for (std::size_t i = 0; i < N; ++i)
            elements()[i].get_to(to[i]);
    }

    /// @param indent  spaces for each level; -1: all in one line
    [[nodiscard]] std::string dump(int indent = -1) const;
    /// @throws JsonError
    [[nodiscard]] static Json parse(const std::string& text);

    using Value = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double,
                               std::string, Array, Object>;
    [[nodiscard]] const Value& value() const { return value_; }

  private:
    [[nodiscard]] const Array& elements() const;

    Value value_;
};

TONEWRIGHT_NAMESPACE_END
