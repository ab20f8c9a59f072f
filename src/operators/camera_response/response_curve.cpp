// SPDX-License-Identifier: Apache-2.0
#include "operators/camera_response/response_curve.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
constexpr const char* kLayouts =
    "columns irradiance and intensity, columns irradiance, red, green, blue, or DoRF's six lines a "
    "curve";
constexpr std::array<std::string_view, 3> kChannels = {"red", "green", "blue"};

/// Text of the file for a message of one line.
std::string shown(std::string_view text) { return text.empty() ? "empty" : printable(text, 40); }

std::string count_of(std::size_t n, const std::string& what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

struct Line {
    std::string_view text;
    std::size_t number = 0;
};

/// Lines one after the other, without those that are blank or a comment. Any line ending will do.
class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
    }

    std::optional<Line> next() {
        while (!rest_.empty()) {
            const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
            const std::string_view line = trimmed(rest_.substr(0, end));
            rest_.remove_prefix(end);
            rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : (rest_.empty() ? 0 : 1));
            ++number_;
            if (!line.empty() && line.front() != '#') return Line{line, number_};
        }
        return std::nullopt;
    }

    /// Position of the line that next() gave, or of the last one.
    [[nodiscard]] std::size_t number() const { return std::max<std::size_t>(number_, 1); }

  private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// One table under construction for each column of pixel values.
struct Samples {
    std::vector<double> irradiance;
    std::vector<std::vector<double>> intensity;

    /// The last of equal irradiances counts.
    void add(double x, const std::vector<double>& y) {
        const bool is_new = irradiance.empty() || x > irradiance.back();
        if (is_new) irradiance.push_back(x);
        intensity.resize(y.size());
        for (std::size_t c = 0; c < y.size(); ++c) {
            if (is_new) {
                intensity[c].push_back(y[c]);
            } else {
                intensity[c].back() = y[c];
            }
        }
    }

    [[nodiscard]] bool has_equal_distances() const {
        const auto last = static_cast<double>(irradiance.size() - 1);
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            if (irradiance[i] != static_cast<double>(i) / last) return false;
        }
        return true;
    }

    [[nodiscard]] std::shared_ptr<const Table> table(std::size_t column) const {
        auto table = std::make_shared<Table>();
        table->samples = intensity[column];
        if (!has_equal_distances()) table->positions = irradiance;
        return table;
    }
};

ResponseCurves shared_where_equal(ResponseCurves curves) {
    for (std::size_t c = 1; c < curves.size(); ++c) {
        for (std::size_t k = c; k-- > 0;) {
            if (curves[c]->samples == curves[k]->samples &&
                curves[c]->positions == curves[k]->positions) {
                curves[c] = curves[k];
            }
        }
    }
    return curves;
}

class Reader {
  public:
    Reader(std::string_view text, const std::string& file, std::string_view curve)
        : text_(text), file_(file), curve_(curve) {}

    ResponseCurves read() const {
        Lines lines(text_);
        const std::optional<Line> first = lines.next();
        if (!first) refuse(lines.number(), "no curve", kLayouts);
        // The label would be the third line; a file that has lost one still is of this layout.
        std::optional<Line> line = first;
        for (int i = 0; line && i < 6; ++i) {
            if (is_label(line->text, 'I')) return read_dorf();
            line = lines.next();
        }
        return read_columns(*first);
    }

  private:
    [[noreturn]] void refuse(std::size_t line, const std::string& reason,
                             const std::string& expected) const {
        throw FileError(file_ + ":" + std::to_string(line) + ": " + reason + "; expected " +
                        expected);
    }

    [[nodiscard]] double number(std::string_view word, std::size_t line,
                                const std::string& what) const {
        std::string_view digits = word;
        if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
        double value = 0;
        const char* end = digits.data() + digits.size();
        const auto result = std::from_chars(digits.data(), end, value);
        if (result.ec != std::errc() || result.ptr != end || !(value >= 0 && value <= 1)) {
            refuse(line, what + " is " + shown(word), "a number in [0, 1]");
        }
        return value + 0.0;  // no -0
    }

    void must_not_fall(double before, double value, std::size_t line,
                       const std::string& what) const {
        if (value < before) {
            refuse(line, what + " is " + shortest(value) + " after " + shortest(before),
                   "it not to fall");
        }
    }

    void must_have_two(const Samples& samples, std::size_t line) const {
        if (samples.irradiance.size() < 2) {
            refuse(line, count_of(samples.irradiance.size(), "sample") + " of different irradiance",
                   "2 or more");
        }
    }

    // ---------------------------------------------------------------------------------------------
    // Columns

    static std::vector<std::string_view> fields_of(std::string_view line, char separator) {
        line = trimmed(line.substr(0, line.find('#')));
        std::vector<std::string_view> fields;
        if (separator != ' ') {
            while (true) {
                const std::size_t end = line.find(separator);
                fields.push_back(trimmed(line.substr(0, end)));
                if (end == std::string_view::npos) return fields;
                line.remove_prefix(end + 1);
            }
        }
        while (!line.empty()) {
            const std::size_t end = std::min(line.find_first_of(" \t\v\f"), line.size());
            fields.push_back(line.substr(0, end));
            line = trimmed(line.substr(end));
        }
        return fields;
    }

    /// Names of columns: no field of it begins like a number.
    static bool is_header(const std::vector<std::string_view>& fields) {
        return std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
            double value = 0;
            const auto r = std::from_chars(field.data(), field.data() + field.size(), value);
            return r.ec == std::errc::invalid_argument;
        });
    }

    [[nodiscard]] ResponseCurves read_columns(const Line& first) const {
        char separator = ' ';
        for (const char c : {',', ';'}) {
            if (separator == ' ' && first.text.find(c) != std::string_view::npos) separator = c;
        }
        const std::size_t columns = fields_of(first.text, separator).size();
        if (columns != 2 && columns != 4) {
            refuse(first.number, count_of(columns, "column") + " in " + shown(first.text),
                   kLayouts);
        }
        Samples samples;
        Lines lines(text_);
        std::vector<double> intensity(columns - 1);
        std::vector<double> before(columns);
        while (const std::optional<Line> line = lines.next()) {
            const std::vector<std::string_view> fields = fields_of(line->text, separator);
            if (separator != ' ' && line->number == first.number && is_header(fields)) continue;
            if (fields.size() != columns) {
                refuse(line->number, count_of(fields.size(), "column"),
                       std::to_string(columns) + " as in line " + std::to_string(first.number));
            }
            for (std::size_t c = 0; c < columns; ++c) {
                const std::string what = name_of(c, columns);
                const double value = number(fields[c], line->number, what);
                must_not_fall(before[c], value, line->number, what);
                before[c] = value;
                if (c > 0) intensity[c - 1] = value;
            }
            samples.add(before[0], intensity);
        }
        must_have_two(samples, lines.number());
        return choose_columns(samples);
    }

    static std::string name_of(std::size_t column, std::size_t columns) {
        if (column == 0) return "irradiance";
        return (columns == 2 ? "" : std::string(kChannels[column - 1]) + " ") + "intensity";
    }

    [[nodiscard]] ResponseCurves choose_columns(const Samples& samples) const {
        const bool is_one = samples.intensity.size() == 1;
        std::array<std::size_t, 3> column = {0, is_one ? 0U : 1U, is_one ? 0U : 2U};
        if (!curve_.empty()) {
            const std::vector<std::string> names(kChannels.begin(), kChannels.end());
            const auto it = std::find(names.begin(), names.end(), curve_);
            if (is_one || it == names.end()) {
                throw Error(file_ + ": curve is " + shown(curve_) + "; expected " +
                            (is_one ? "none, the file has one for all channels"
                                    : "none (each channel has its own), " + join_choices(names) +
                                          did_you_mean(curve_, names)));
            }
            column.fill(static_cast<std::size_t>(it - names.begin()));
        }
        return shared_where_equal(
            {samples.table(column[0]), samples.table(column[1]), samples.table(column[2])});
    }

    // ---------------------------------------------------------------------------------------------
    // DoRF

    struct Record {
        Line name, irradiance, intensity;
    };

    /// `I =`
    static bool is_label(std::string_view line, char letter) {
        return line.front() == letter && trimmed(line.substr(1)) == "=";
    }

    [[nodiscard]] std::vector<Record> records() const {
        static constexpr std::array<const char*, 6> kParts = {
            "a name", "the kind of graph", "`I =`", "irradiances", "`B =`", "intensities"};
        std::vector<Record> all;
        Lines lines(text_);
        while (const std::optional<Line> name = lines.next()) {
            std::array<Line, 6> record = {*name};
            for (std::size_t i = 0; i < record.size(); ++i) {
                if (i > 0) {
                    const std::size_t last = record[i - 1].number;
                    const std::optional<Line> line = lines.next();
                    if (!line) {
                        refuse(last, "curve " + shown(name->text) + " ends here",
                               std::string(kParts[i]) + " in the next line, six lines a curve");
                    }
                    record[i] = *line;
                }
                const bool is_i = is_label(record[i].text, 'I');
                const bool is_b = is_label(record[i].text, 'B');
                if (is_i != (i == 2) || is_b != (i == 4)) {
                    refuse(record[i].number, "line is " + shown(record[i].text),
                           std::string(kParts[i]) + ", six lines a curve");
                }
            }
            all.push_back({record[0], record[3], record[5]});
        }
        return all;
    }

    [[nodiscard]] std::vector<double> series(const Line& line, const std::string& what,
                                             const std::string& curve) const {
        std::vector<double> values;
        for (const std::string_view word : fields_of(line.text, ' ')) {
            std::string which = what;
            which.append(" ").append(std::to_string(values.size() + 1));
            which.append(" of ").append(curve);
            const double value = number(word, line.number, which);
            must_not_fall(values.empty() ? 0 : values.back(), value, line.number, which);
            values.push_back(value);
        }
        return values;
    }

    [[nodiscard]] std::shared_ptr<const Table> table_of(const Record& record) const {
        const std::string curve = shown(record.name.text);
        const std::vector<double> x = series(record.irradiance, "irradiance", curve);
        const std::vector<double> y = series(record.intensity, "intensity", curve);
        if (x.size() != y.size()) {
            refuse(record.intensity.number,
                   curve + " has " + count_of(y.size(), "number") + " behind `B =` and " +
                       std::to_string(x.size()) + " behind `I =`",
                   "as many");
        }
        Samples samples;
        for (std::size_t i = 0; i < x.size(); ++i)
            samples.add(x[i], {y[i]});
        must_have_two(samples, record.irradiance.number);
        return samples.table(0);
    }

    struct Endings {
        std::array<std::string_view, 3> of;
    };
    static constexpr std::array<Endings, 5> kEndings = {{{{"Red", "Green", "Blue"}},
                                                         {{"red", "green", "blue"}},
                                                         {{"RED", "GREEN", "BLUE"}},
                                                         {{"R", "G", "B"}},
                                                         {{"r", "g", "b"}}}};
    static constexpr std::array<std::string_view, 5> kJoints = {"", "-", "_", " ", "."};

    /// Names that a user may ask for: three curves by the common part of their names, other curves
    /// by name.
    static std::vector<std::string> choices(const std::vector<Record>& all) {
        std::set<std::string_view> names;
        for (const Record& record : all)
            names.insert(record.name.text);
        std::vector<std::string> result;
        std::set<std::string> in_three;
        for (const Record& record : all) {
            const std::string name(record.name.text);
            if (in_three.contains(name)) continue;
            bool is_one = true;
            for (const auto& [endings] : kEndings) {
                for (const std::string_view ending : endings) {
                    if (!is_one || name.size() <= ending.size() || !name.ends_with(ending))
                        continue;
                    const std::string stem = name.substr(0, name.size() - ending.size());
                    std::array<std::string, 3> three;
                    for (std::size_t c = 0; c < 3; ++c)
                        three[c] = stem + std::string(endings[c]);
                    if (!std::all_of(three.begin(), three.end(),
                                     [&](const std::string& one) { return names.contains(one); })) {
                        continue;
                    }
                    is_one = false;
                    in_three.insert(three.begin(), three.end());
                    const std::string bare = stem.substr(0, stem.find_last_not_of("-_ .") + 1);
                    result.push_back(stem.size() == bare.size() + 1 ? bare : stem);
                }
            }
            if (is_one) result.push_back(name);
        }
        return result;
    }

    /// @return null when there is none
    [[nodiscard]] const Record* find(const std::vector<Record>& all, std::string_view name) const {
        const Record* found = nullptr;
        for (const Record& record : all) {
            if (record.name.text != name) continue;
            if (found) {
                refuse(record.name.number,
                       "second curve " + shown(name) + " after line " +
                           std::to_string(found->name.number),
                       "names that differ");
            }
            found = &record;
        }
        return found;
    }

    [[nodiscard]] ResponseCurves read_dorf() const {
        const std::vector<Record> all = records();
        if (!curve_.empty()) {
            if (const auto curves = select(all, curve_)) return *curves;
        }
        const std::vector<std::string> names = choices(all);
        if (curve_.empty() && names.size() == 1) {
            if (const auto curves = select(all, names[0])) return *curves;
        }
        constexpr std::size_t kShown = 8;
        std::vector<std::string> first;
        for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
            first.push_back(shown(names[i]));
        const std::string of = names.size() > kShown
                                   ? "one of its " + std::to_string(names.size()) + ", such as "
                                   : "";
        throw Error(file_ + ": curve is " + shown(curve_) + "; expected " + of +
                    join_choices(first) + (curve_.empty() ? "" : did_you_mean(curve_, names)));
    }

    /// The curve of this name, else the three that begin with it.
    [[nodiscard]] std::optional<ResponseCurves> select(const std::vector<Record>& all,
                                                       const std::string& name) const {
        if (const Record* one = find(all, name)) {
            const std::shared_ptr<const Table> table = table_of(*one);
            return ResponseCurves{table, table, table};
        }
        for (const std::string_view joint : kJoints) {
            for (const auto& [endings] : kEndings) {
                std::array<const Record*, 3> three{};
                for (std::size_t c = 0; c < 3; ++c)
                    three[c] = find(all, name + std::string(joint) + std::string(endings[c]));
                if (three[0] && three[1] && three[2]) {
                    return shared_where_equal(
                        {table_of(*three[0]), table_of(*three[1]), table_of(*three[2])});
                }
            }
        }
        return std::nullopt;
    }

    std::string_view text_;
    const std::string& file_;
    std::string curve_;
};

std::string contents_of(const std::string& file) {
    return read_file(file, kMaxBytes, [&](const Problem& why) {
        throw FileError(within(file + ": cannot read", why));
    });
}

}  // namespace

ResponseCurves parse_response_curves(std::string_view text, const std::string& file,
                                     std::string_view curve) {
    return Reader(text, file, curve).read();
}

ResponseCurves read_response_curves(const std::string& file, std::string_view curve) {
    return parse_response_curves(contents_of(file), file, curve);
}

TONEWRIGHT_NAMESPACE_END
