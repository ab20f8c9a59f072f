// SPDX-License-Identifier: Apache-2.0
#include "shader/print.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "base/format_number.h"
#include "expr/nodes.h"
#include "shader/body.h"
#include "shader/grid_form.h"
#include "shader/texture_form.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

class ProgramPrinter {
  public:
    ProgramPrinter(const ShaderProgram& program, const LanguageFacts& language, std::string name,
                   std::vector<std::string> uniforms, ShaderTables tables)
        : program_(program),
          language_(language),
          name_(std::move(name)),
          uniforms_(std::move(uniforms)),
          tables_(tables) {}

    PrintedProgram print() {
        print_tables();
        for (const MatrixFunction& function : program_.matrices)
            print_matrix(function);
        for (const ScalarFunction& function : program_.scalars)
            print_scalar(function);
        for (const ColorFunction& function : program_.colors)
            print_color(function);
        print_entry();
        return {std::move(text_), std::move(textures_)};
    }

  private:
    [[nodiscard]] std::string helper(const std::string& name) const { return name_ + "_" + name; }
    [[nodiscard]] std::string literal(double value) const {
        return float_literal(value, language_);
    }
    [[nodiscard]] std::string declared(const char* type, const std::string& name) const {
        return fmt::format(fmt::runtime(language_.parameter), fmt::arg("type", type),
                           fmt::arg("name", name));
    }
    [[nodiscard]] std::string made(const std::array<std::string, 3>& c) const {
        return fmt::format("{}({}, {}, {})", language_.make_color, c[0], c[1], c[2]);
    }
    /// The same on separate lines.
    [[nodiscard]] std::string made_on_lines(const std::array<std::string, 3>& c) const {
        return fmt::format("{}(\n        {},\n        {},\n        {})", language_.make_color, c[0],
                           c[1], c[2]);
    }
    [[nodiscard]] std::array<std::string, 3> channels_of(const std::string& color) const {
        return {color + language_.channel[0], color + language_.channel[1],
                color + language_.channel[2]};
    }
    void line(const std::string& text) { text_ += "    " + text + "\n"; }

    void begin(const char* result, const std::string& name,
               const std::vector<std::string>& parameters) {
        text_ += fmt::format("\n{}{} {{\n", language_.before_function,
                             fmt::format(fmt::runtime(language_.function),
                                         fmt::arg("result", result), fmt::arg("name", name),
                                         fmt::arg("parameters", fmt::join(parameters, ", "))));
    }
    void end() { text_ += "}\n"; }

    /// Uniforms that the expressions read, in the order of the program, and textures if these are
    /// arguments.
    [[nodiscard]] std::vector<std::string> read_uniforms(std::span<const Expr> exprs) const {
        const std::vector<std::string> read = uniforms_of(exprs);
        std::vector<std::string> result;
        for (const std::string& uniform : uniforms_) {
            if (std::find(read.begin(), read.end(), uniform) != read.end())
                result.push_back(uniform);
        }
        for (const Expr& e : nodes_of(exprs)) {
            const void* const what = table_of(e);
            if (!what) continue;
            const std::string& texture = table_texts_.at(what).texture;
            if (!texture.empty() &&
                std::find(result.begin(), result.end(), texture) == result.end())
                result.push_back(texture);
        }
        return result;
    }
    /// Type and name of an argument after the color.
    [[nodiscard]] std::string declared_argument(const std::string& name) const {
        const auto texture = std::find_if(textures_.begin(), textures_.end(),
                                          [&](const ShaderTexture& t) { return t.name == name; });
        if (texture == textures_.end()) return declared(language_.number, name);
        return fmt::format(
            fmt::runtime(language_.tables && holds_tables(*texture) ? language_.tables->parameter
                                                                    : language_.texture_parameter),
            fmt::arg("name", name));
    }
    [[nodiscard]] std::vector<std::string> parameters(
        const char* type, const std::string& name, const std::vector<std::string>& uniforms) const {
        std::vector<std::string> result = {declared(type, name)};
        for (const std::string& uniform : uniforms)
            result.push_back(declared_argument(uniform));
        return result;
    }
    static std::string call(const std::string& name, const std::string& argument,
                            const std::vector<std::string>& uniforms) {
        std::string text = name + "(" + argument;
        for (const std::string& uniform : uniforms)
            text += ", " + uniform;
        return text + ")";
    }
    [[nodiscard]] std::string scalar_call(std::size_t function, const std::string& argument) const {
        const ScalarFunction& f = program_.scalars[function];
        return call(helper(f.name), argument, read_uniforms(std::span(&f.f, 1)));
    }
    [[nodiscard]] std::vector<std::string> uniforms_of_color(const ColorFunction& function) const {
        std::vector<Expr> all(function.f.begin(), function.f.end());
        for (const ColorFunction::Call& c : function.calls) {
            all.push_back(c.argument);
            all.push_back(program_.scalars[c.function].f);
        }
        return read_uniforms(all);
    }

    /// The table or the Grid that an expression reads; null: none.
    static const void* table_of(const Expr& e) {
        if (e.op() == ExprOp::lookup) return e.table().get();
        return e.op() == ExprOp::grid ? e.grid().get() : nullptr;
    }

    void print_tables() {
        std::vector<std::pair<std::string, std::vector<Expr>>> functions;
        for (const ScalarFunction& function : program_.scalars)
            functions.push_back({function.name, {function.f}});
        for (const ColorFunction& function : program_.colors) {
            std::vector<Expr> all(function.f.begin(), function.f.end());
            for (const ColorFunction::Call& c : function.calls)
                all.push_back(c.argument);
            functions.emplace_back(function.name, all);
        }
        if (language_.tables) {
            std::vector<Expr> all;
            for (const auto& function : functions)
                all.insert(all.end(), function.second.begin(), function.second.end());
            print_texture_of_tables(all);
        }
        for (const auto& function : functions)
            print_tables_of(function.first, function.second);
    }

    /// Tables that no earlier function reads.
    void print_tables_of(const std::string& function, const std::vector<Expr>& exprs) {
        int tables = 0;
        int grids = 0;
        const auto numbered = [&](const std::string& name, int number) {
            return helper(name + (number > 1 ? std::to_string(number) : ""));
        };
        for (const Expr& e : nodes_of(exprs)) {
            const void* const what = table_of(e);
            if (!what || table_texts_.contains(what)) continue;
            if (e.op() == ExprOp::lookup) {
                print_table(numbered(function + "_table", ++tables), *e.table());
            } else {
                const std::string name = numbered(function + "_at", ++grids);
                table_texts_[what] = {name};
                print_grid(name, *e.grid());
            }
        }
    }

    [[nodiscard]] std::string array(const std::string& name, std::span<const double> numbers) {
        std::string values;
        std::string row;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const std::string number = literal(numbers[i]) + (i + 1 < numbers.size() ? "," : "");
            if (row.size() + number.size() > 92) {
                values += "    " + row + "\n";
                row.clear();
            }
            row += (row.empty() ? "" : " ") + number;
        }
        values += "    " + row;
        return fmt::format(fmt::runtime(language_.array), fmt::arg("name", name),
                           fmt::arg("count", numbers.size()), fmt::arg("values", values)) +
               "\n";
    }

    [[nodiscard]] std::string let(const char* type, const char* name,
                                  const std::string& value) const {
        return fmt::format(fmt::runtime(language_.let), fmt::arg("type", type),
                           fmt::arg("name", name), fmt::arg("value", value));
    }
    [[nodiscard]] std::string variable(const char* name, const std::string& value) const {
        return fmt::format(fmt::runtime(language_.variable), fmt::arg("type", language_.integer),
                           fmt::arg("name", name), fmt::arg("value", value));
    }
    [[nodiscard]] std::string to_integer(const std::string& value) const {
        return fmt::format(fmt::runtime(language_.to_integer), fmt::arg("value", value));
    }
    [[nodiscard]] std::string to_number(const std::string& value) const {
        return fmt::format(fmt::runtime(language_.to_number), fmt::arg("value", value));
    }
    [[nodiscard]] std::string limited(const std::string& x, const std::string& lo,
                                      const std::string& hi) const {
        return fmt::format("{}({}({}, {}), {})", language_.minimum, language_.maximum, x, lo, hi);
    }

    /// True for a 1D table that becomes a texture. `formula` is about nodes of 3D LUTs alone.
    /// @throws Error  if neither an array nor a texture can hold that many
    [[nodiscard]] bool is_texture(const Table& table) const {
        const std::size_t numbers = table.samples.size();
        const bool has_texture =
            language_.is_for_grids ? language_.tables != nullptr : language_.has_textures;
        const bool is_small = numbers <= language_.largest_array;
        const bool result = tables_ == ShaderTables::by_size || tables_ == ShaderTables::formula
                                ? !is_small
                                : tables_ == ShaderTables::texture;
        if (result ? has_texture : is_small) return result;
        const std::string& id = std::find_if(shader_languages().begin(), shader_languages().end(),
                                             [&](const ShaderLanguageInfo& info) {
                                                 return info.language == language_.language;
                                             })
                                    ->id;
        const std::string reads = fmt::format("{} reads a table of {} numbers", name_, numbers);
        if (!has_texture && !is_small) {
            throw Error(
                Problem{.value = reads,
                        .expected = "a language with textures: glsl, glsl-es, hlsl, wgsl; or c"});
        }
        throw Error(Problem{
            .value = reads + "; tables is " + (result ? "texture" : "array"),
            .expected = result
                            ? "array: no texture of 32-bit floats is possible there"
                            : fmt::format("texture: an array in {} should hold at most {} numbers, "
                                          "not {}",
                                          id, language_.largest_array, numbers)});
    }

    /// Declares a texture; the caller fills in its texels.
    ShaderTexture& declare_texture(const std::string& name, const std::array<int, 3>& size) {
        return declare_texture(name, size, language_.texel, language_.loader, language_.texture);
    }
    ShaderTexture& declare_texture(const std::string& name, const std::array<int, 3>& size,
                                   const char* texel, const char* loader, const char* declaration) {
        if (language_.has_one_texture && !textures_.empty()) {
            throw Error(Problem{.value = name_ + " reads a 3D LUT and tables",
                                .expected = "<<tables=formula>>: a texture is possible for one"});
        }
        const auto filled = [&](const char* pattern) {
            return fmt::format(fmt::runtime(pattern), fmt::arg("name", name),
                               fmt::arg("binding", language_.first_binding + textures_.size()),
                               fmt::arg("width", size[0]), fmt::arg("height", size[1]),
                               fmt::arg("depth", size[2]), fmt::arg("edge", size[0]),
                               fmt::arg("pitch", 16 * size[0]));
        };
        const bool is_flat = language_.tables && size[2] == 1;
        text_ += fmt::format("\n// {}: {} texels, RGBA, {}, no filter.\n", name,
                             fmt::join(std::span(size).first(is_flat ? 2 : 3), " x "), texel) +
                 filled(loader) + filled(declaration);
        return textures_.emplace_back(ShaderTexture{name, size, {}});
    }

    static constexpr int kTableWidth = 256;  // limit of 3D textures in GLSL ES

    /// A function that gives channel `channel` of texel i of a table's texture.
    void print_texel(const std::string& name, const std::string& texture, std::size_t channel) {
        begin(language_.number, name, {declared(language_.integer, "i")});
        line("return " +
             fmt::format(fmt::runtime(language_.fetch), fmt::arg("name", texture),
                         fmt::arg("x", fmt::format("i % {}", kTableWidth)),
                         fmt::arg("y", fmt::format("i / {}", kTableWidth)), fmt::arg("z", "0")) +
             language_.channel[channel] + ";");
        end();
    }

    /// Declares the texture of all tables that become one. Equal arrays, such as the positions of
    /// several tables, share a place.
    void print_texture_of_tables(const std::vector<Expr>& exprs) {
        std::vector<const std::vector<double>*> arrays;
        std::size_t longest = 0;
        for (const Expr& e : nodes_of(exprs)) {
            if (e.op() != ExprOp::lookup || !is_texture(*e.table())) continue;
            for (const auto* numbers : {&e.table()->samples, &e.table()->positions}) {
                if (numbers->empty() || !fetches_.try_emplace(*numbers).second) continue;
                arrays.push_back(numbers);
                longest = std::max(longest, numbers->size());
            }
        }
        if (arrays.empty()) return;
        // Each channel of a row holds another array.
        constexpr std::array kChannels = {".r", ".g", ".b", ".a"};
        const TextureForm& form = *language_.tables;
        const auto width = std::min(longest, static_cast<std::size_t>(form.largest_width));
        const std::size_t rows = (longest + width - 1) / width;
        const std::size_t height =
            rows * ((arrays.size() + kChannels.size() - 1) / kChannels.size());
        ShaderTexture& texture = declare_texture(
            helper("tables"), {static_cast<int>(width), static_cast<int>(height), 1},
            "32-bit floats", form.note, form.declaration);
        texture.rgba.resize(kChannels.size() * width * height);
        for (std::size_t k = 0; k < arrays.size(); ++k) {
            const std::size_t channel = k % kChannels.size();
            const std::size_t row = k / kChannels.size() * rows;
            for (std::size_t i = 0; i < arrays[k]->size(); ++i) {
                texture.rgba[kChannels.size() * (row * width + i) + channel] =
                    static_cast<float>((*arrays[k])[i]);
            }
            // GLSL ES 1.00 has no %.
            const std::string x =
                rows == 1 ? "{i}" : fmt::format("({{i}}) - {0} * (({{i}}) / {0})", width);
            std::string y = row > 0 || rows == 1 ? std::to_string(row) : "";
            if (rows > 1) y += fmt::format("{}({{i}}) / {}", row > 0 ? " + " : "", width);
            fetches_[*arrays[k]] =
                fmt::format(fmt::runtime(form.fetch), fmt::arg("name", texture.name),
                            fmt::arg("x", x), fmt::arg("y", y), fmt::arg("width", width),
                            fmt::arg("height", height)) +
                kChannels.at(channel);
        }
    }

    /// Access to the numbers of a table: patterns with {i}, arrays that are local to the function,
    /// and the texture if it is an argument.
    struct StoredTable {
        std::string value;
        std::string position;
        std::string local_values = {};
        std::string local_positions = {};
        std::string argument = {};
    };

    StoredTable store(const std::string& name, const Table& table) {
        const std::string values = name + "_values";
        const std::string positions = name + "_positions";
        const std::size_t count = table.samples.size();
        const bool is_new = !table.positions.empty() && !searches_.contains(search_of(table));
        if (!is_texture(table)) {
            StoredTable stored{values + "[{i}]", positions + "[{i}]", array(values, table.samples)};
            if (is_new) stored.local_positions = array(positions, table.positions);
            if (language_.has_local_arrays) return stored;
            text_ += "\n" + stored.local_values + stored.local_positions;
            stored.local_values.clear();
            stored.local_positions.clear();
            return stored;
        }
        if (language_.tables) {
            return {.value = fetches_.at(table.samples),
                    .position = table.positions.empty() ? "" : fetches_.at(table.positions),
                    .argument = *language_.tables->parameter ? helper("tables") : ""};
        }
        const int rows = (static_cast<int>(count) + kTableWidth - 1) / kTableWidth;
        ShaderTexture& texture = declare_texture(values, {kTableWidth, rows, 1});
        texture.rgba.resize(4 * static_cast<std::size_t>(kTableWidth * rows));
        for (std::size_t i = 0; i < count; ++i) {
            texture.rgba[4 * i] = static_cast<float>(table.samples[i]);
            if (!table.positions.empty())
                texture.rgba[4 * i + 1] = static_cast<float>(table.positions[i]);
        }
        print_texel(name + "_value", values, 0);
        if (is_new) print_texel(name + "_position", values, 1);
        return {name + "_value({i})", name + "_position({i})"};
    }

    /// A function that finds the cell of a number, and a pattern with {i} of a position.
    struct Search {
        std::string function;
        std::string position;
    };
    /// Tables with the same key have the same cells.
    static std::pair<Table::Interpolation, std::vector<double>> search_of(const Table& table) {
        return {table.interpolation, table.positions};
    }

    static std::string at(const std::string& pattern, const std::string& i) {
        return fmt::format(fmt::runtime(pattern), fmt::arg("i", i));
    }

    /// Lines that find the cell of x among `count` positions.
    void print_search(const std::string& position, std::size_t count) {
        constexpr std::size_t kMostInLines = 64;
        line(variable("cell", "0"));
        if (std::has_single_bit(count) && count <= kMostInLines) {
            for (std::size_t step = count / 2; step > 0; step /= 2) {
                line(fmt::format("if (x >= {}) {{ cell += {}; }}",
                                 at(position, fmt::format("cell + {}", step)), step));
            }
            return;
        }
        line(variable("next", std::to_string(count)));
        line(fmt::format(fmt::runtime(language_.loop),
                         fmt::arg("count", std::bit_width(count - 1))) +
             " {");
        line("    " +
             let(language_.integer, "middle",
                 fmt::format(fmt::runtime(language_.half), fmt::arg("value", "cell + next"))));
        line(fmt::format("    if (x < {}) {{ next = middle; }} else {{ cell = middle; }}",
                         at(position, "middle")));
        line("}");
    }

    void print_table(const std::string& name, const Table& table) {
        const StoredTable stored = store(name, table);
        const std::size_t n = table.samples.size();
        const bool is_step = table.interpolation == Table::Interpolation::step;
        const char* const number = language_.number;
        const auto value_at = [&](const char* i) { return at(stored.value, i); };
        std::vector<std::string> of_x = {declared(number, "x")};
        if (!stored.argument.empty()) of_x.push_back(declared_argument(stored.argument));
        // Local positions are in the function that reads them.
        const bool has_search =
            !table.positions.empty() && n > 1 && (is_step || !language_.has_local_arrays);
        Search own = {"", stored.position};
        Search& search = has_search ? searches_[search_of(table)] : own;
        if (has_search && search.function.empty()) {
            search = {name + "_cell", stored.position};
            begin(language_.integer, search.function, of_x);
            text_ += stored.local_positions;
            print_search(search.position, is_step ? n : n - 1);
            line("return cell;");
            end();
        }
        if (is_step && has_search) {
            if (!stored.local_values.empty()) {
                begin(number, name + "_value", {declared(language_.integer, "i")});
                text_ += stored.local_values;
                line("return " + value_at("i") + ";");
                end();
            }
            table_texts_[&table] = {
                stored.local_values.empty() ? value_at("{cell}") : name + "_value({cell})",
                search.function, stored.argument};
            return;
        }
        if (has_search) {
            const std::string texture = stored.argument.empty() ? "" : ", " + stored.argument;
            table_texts_[&table] = {name + "({x}, {cell}" + texture + ")", search.function,
                                    stored.argument};
            of_x.insert(of_x.begin() + 1, declared(language_.integer, "cell"));
        } else {
            table_texts_[&table] = {name, "", stored.argument};
        }
        begin(number, name, of_x);
        text_ += stored.local_values + stored.local_positions;
        if (n == 1) {
            line("return " + value_at("0") + ";");
            return end();
        }
        if (table.positions.empty()) {
            const auto cells = static_cast<double>(is_step ? n : n - 1);
            line(let(number, "place",
                     fmt::format("{} * {}", limited("x", literal(0), literal(1)), literal(cells))));
            line(let(language_.integer, "cell",
                     to_integer(fmt::format("{}({}, {})", language_.minimum, "place",
                                            literal(cells - 1)))));
            if (!is_step) line(let(number, "t", fmt::format("place - {}", to_number("cell"))));
        } else {
            if (!has_search) print_search(search.position, n - 1);
            line(let(number, "begin", at(search.position, "cell")));
            line(let(number, "width", at(search.position, "cell + 1") + " - begin"));
            line(let(number, "t", limited("(x - begin) / width", literal(0), literal(1))));
        }
        if (is_step) {
            line("return " + value_at("cell") + ";");
        } else {
            line(let(number, "value", value_at("cell")));
            line(fmt::format("return value + t * ({} - value);", value_at("cell + 1")));
        }
        end();
    }

    /// Prints a function of a color with this name from the expressions.
    void print_formula(const std::string& name, Span<const Expr> f) {
        const std::array<std::string, 3> c = channels_of("c");
        FunctionBody body(language_, {c.begin(), c.end()}, {"c"}, {}, {});
        std::array<std::string, 3> out;
        for (const Expr& e : f)
            body.count(e);
        for (std::size_t i = 0; i < 3; ++i)
            out[i] = body.value(f[i]);
        text_ += "\n// Computes a node of the 3D LUT from its place in [0, 1] on each axis.";
        begin(language_.color, name, {declared(language_.color, "c")});
        text_ += body.lines();
        line("return " + made_on_lines(out) + ";");
        end();
    }

    /// Text that gives a node of the Grid: from an array, from a texture or computed.
    std::string print_nodes(const std::string& name, const Grid& grid) {
        const std::string nodes = name + "_nodes";
        const GridSource source = grid_source(grid, language_, tables_, name_);
        if (source == GridSource::formula) {
            const std::string formula = name + "_formula";
            print_formula(formula, node_formula(grid));
            const std::string node = name + "_node";
            begin(language_.color, node,
                  {declared(language_.integer, "r"), declared(language_.integer, "g"),
                   declared(language_.integer, "b")});
            const auto place = [&](const char* axis) {
                return to_number(axis) + " / " + literal(grid.edge() - 1);
            };
            line("return " + formula + "(" + made({place("r"), place("g"), place("b")}) + ");");
            end();
            return node + "({r}, {g}, {b})";
        }
        const std::vector<double>& numbers = grid.nodes();
        if (source == GridSource::array) {
            const std::string values = array(nodes, numbers);
            if (!language_.has_local_arrays) text_ += "\n" + values;
            const std::string node = name + "_node";
            begin(language_.color, node,
                  {declared(language_.integer, "r"), declared(language_.integer, "g"),
                   declared(language_.integer, "b")});
            if (language_.has_local_arrays) text_ += values;
            line(let(language_.integer, "i",
                     fmt::format("3 * ((r * {0} + g) * {0} + b)", grid.edge())));
            line("return " + made({nodes + "[i]", nodes + "[i + 1]", nodes + "[i + 2]"}) + ";");
            end();
            return node + "({r}, {g}, {b})";
        }
        ShaderTexture& texture = declare_texture(nodes, {grid.edge(), grid.edge(), grid.edge()});
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            texture.rgba.push_back(static_cast<float>(numbers[i]));
            if (i % 3 == 2) texture.rgba.push_back(1);
        }
        if (language_.is_double && grid.has_formula()) {
            texture.formula = nodes + "_formula";
            print_formula(texture.formula, grid.formula());
        }
        // The third coordinate runs fastest.
        return fmt::format(fmt::runtime(language_.fetch), fmt::arg("name", nodes),
                           fmt::arg("x", "{b}"), fmt::arg("y", "{g}"), fmt::arg("z", "{r}"),
                           fmt::arg("edge", grid.edge()), fmt::arg("last", grid.edge() - 1)) +
               language_.color_of_fetch;
    }

    void print_grid(const std::string& name, const Grid& grid) {
        const std::size_t had = textures_.size();
        const std::string fetch = print_nodes(name, grid);
        const auto node = [&](const char* r, const char* g, const char* b) {
            return fmt::format(fmt::runtime(fetch), fmt::arg("r", r), fmt::arg("g", g),
                               fmt::arg("b", b));
        };
        const char* const number = language_.number;
        const char* const integer = language_.integer;
        const auto yes_or_no = [&](const std::string& condition) {
            return fmt::format(fmt::runtime(language_.choose), fmt::arg("condition", condition),
                               fmt::arg("yes", "1"), fmt::arg("no", "0"));
        };
        const std::string min = language_.minimum;
        const std::string max = language_.maximum;
        TableText& text = table_texts_[&grid];
        const bool is_argument = *language_.texture_parameter && textures_.size() > had;
        if (is_argument) text.texture = textures_.back().name;
        std::vector<std::string> arguments;
        if (!text.texture.empty()) arguments = {text.texture};
        begin(language_.color, name, parameters(language_.color, "c", arguments));
        line("// Between the nodes of a tetrahedron along the gray diagonal.");
        for (std::size_t i = 0; i < 3; ++i) {
            const std::string channel(1, "rgb"[i]);
            line(let(number, ("place_" + channel).c_str(),
                     limited(channels_of("c")[i], literal(0), literal(1)) + " * " +
                         literal(grid.edge() - 1)));
            line(let(integer, channel.c_str(),
                     to_integer(
                         fmt::format("{}(place_{}, {})", min, channel, literal(grid.edge() - 2)))));
            line(let(number, ("f" + channel).c_str(),
                     "place_" + channel + " - " + to_number(channel)));
        }
        // The first step goes along the largest fraction, the last along the smallest.
        line(let(integer, "r1", yes_or_no("fr >= fg && fr >= fb")));
        line(let(integer, "g1", yes_or_no("r1 == 0 && fg >= fb")));
        line(let(integer, "b1", "1 - r1 - g1"));
        line(let(integer, "b3", yes_or_no("fb <= fr && fb <= fg")));
        line(let(integer, "g3", yes_or_no("b3 == 0 && fg <= fr")));
        line(let(integer, "r3", "1 - b3 - g3"));
        line(let(number, "largest", fmt::format("{0}({0}(fr, fg), fb)", max)));
        line(let(number, "smallest", fmt::format("{0}({0}(fr, fg), fb)", min)));
        line(
            let(number, "middle", fmt::format("{1}({0}(fr, fg), {0}({1}(fr, fg), fb))", min, max)));
        const char* const color = language_.color;
        line(let(color, "n0", node("r", "g", "b")));
        line(let(color, "n1", node("r + r1", "g + g1", "b + b1")));
        line(let(color, "n2", node("r + 1 - r3", "g + 1 - g3", "b + 1 - b3")));
        line(let(color, "n3", node("r + 1", "g + 1", "b + 1")));
        std::array<std::string, 3> out;
        for (std::size_t i = 0; i < 3; ++i) {
            out[i] = fmt::format(
                "({1} - largest) * n0{0} + (largest - middle) * n1{0} + (middle - smallest) * "
                "n2{0} + smallest * n3{0}",
                language_.channel[i], literal(1));
        }
        line("return " + made_on_lines(out) + ";");
        end();
    }

    void print_matrix(const MatrixFunction& function) {
        begin(language_.color, helper(function.name), {declared(language_.color, "c")});
        const std::array<std::string, 3> c = channels_of("c");
        std::array<std::string, 3> rows;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& row = function.m[i];
            if (*language_.product) {
                const std::string weights =
                    made({literal(row[0]), literal(row[1]), literal(row[2])});
                rows[i] = fmt::format(fmt::runtime(language_.product), fmt::arg("a", weights),
                                      fmt::arg("b", "c"));
                continue;
            }
            for (std::size_t j = 0; j < 3; ++j) {
                const bool is_minus = j > 0 && row[j] < 0;
                rows[i] += (j ? (is_minus ? " - " : " + ") : "") +
                           literal(is_minus ? -row[j] : row[j]) + " * " + c[j];
            }
        }
        line("return " + made_on_lines(rows) + ";");
        end();
    }

    void print_scalar(const ScalarFunction& function) {
        const std::vector<std::string> uniforms = read_uniforms(std::span(&function.f, 1));
        std::set<std::string> taken(uniforms_.begin(), uniforms_.end());
        taken.insert("x");
        FunctionBody body(language_, {"x"}, taken, program_.names, table_texts_);
        body.count(function.f);
        const std::string value = body.value(function.f);
        begin(language_.number, helper(function.name), parameters(language_.number, "x", uniforms));
        text_ += body.lines();
        line("return " + value + ";");
        end();
    }

    void print_color(const ColorFunction& function) {
        const std::array<std::string, 3> c = channels_of("c");
        std::set<std::string> taken(uniforms_.begin(), uniforms_.end());
        taken.insert("c");
        FunctionBody body(language_, {c.begin(), c.end()}, taken, program_.names, table_texts_);
        for (const ColorFunction::Call& call : function.calls)
            body.count(call.argument);
        for (const Expr& e : function.f)
            body.count(e);
        for (const ColorFunction::Call& call : function.calls) {
            const std::string argument = body.value(call.argument);
            body.add_input(call.result, scalar_call(call.function, argument));
        }
        std::array<std::string, 3> out;
        for (std::size_t i = 0; i < 3; ++i)
            out[i] = body.value(function.f[i]);
        begin(language_.color, helper(function.name),
              parameters(language_.color, "c", uniforms_of_color(function)));
        text_ += body.lines();
        const bool is_short = out[0].size() + out[1].size() + out[2].size() < 70;
        line("return " + (is_short ? made(out) : made_on_lines(out)) + ";");
        end();
    }

    /// Applies `f` to the text of each channel of the color.
    template <class F>
    [[nodiscard]] std::string of_each(const std::string& color, const F& f) const {
        std::array<std::string, 3> c = channels_of(color);
        std::size_t length = 0;
        for (std::string& channel : c) {
            channel = f(channel);
            length += channel.size();
        }
        return length < 70 ? made(c) : made_on_lines(c);
    }

    [[nodiscard]] std::string clamped(const ClampStage& s) const {
        const auto limit = [&](std::string value, const auto& end_of) {
            if (s.lo != -kInfinity)
                value = fmt::format("{}({}, {})", language_.maximum, value, end_of(s.lo));
            if (s.hi != kInfinity)
                value = fmt::format("{}({}, {})", language_.minimum, value, end_of(s.hi));
            return value;
        };
        if (!language_.has_color_math) {
            return of_each("c", [&](const std::string& channel) {
                return limit(channel, [&](double x) { return literal(x); });
            });
        }
        const auto splat = [&](double x) {
            return fmt::format(fmt::runtime(language_.splat), fmt::arg("value", literal(x)));
        };
        if (s.lo == -kInfinity || s.hi == kInfinity) return limit("c", splat);
        return fmt::format("clamp(c, {}, {})", splat(s.lo), splat(s.hi));
    }

    [[nodiscard]] std::string after(const ProgramStep& step) const {
        return std::visit(
            Overloaded{[&](const ScaleStep& s) {
                           const std::string factor = literal(s.factor);
                           if (language_.has_color_math) return "c * " + factor;
                           return of_each("c",
                                          [&](const std::string& x) { return x + " * " + factor; });
                       },
                       [&](const MatrixStep& s) {
                           return helper(program_.matrices[s.function].name) + "(c)";
                       },
                       [&](const ClampStage& s) { return clamped(s); },
                       [&](const ScalarStep& s) {
                           return of_each("c", [&](const std::string& channel) {
                               return scalar_call(s.function, channel);
                           });
                       },
                       [&](const ColorStep& s) {
                           const ColorFunction& function = program_.colors[s.function];
                           return call(helper(function.name), "c", uniforms_of_color(function));
                       }},
            step);
    }

    void print_steps(const std::string& scene) {
        line(fmt::format(fmt::runtime(language_.variable), fmt::arg("type", language_.color),
                         fmt::arg("name", "c"), fmt::arg("value", scene)));
        for (const ProgramStep& step : program_.steps)
            line("c = " + after(step) + ";");
    }

    void print_entry() {
        switch (language_.entry) {
            case LanguageFacts::Entry::function: {
                std::vector<std::string> arguments = uniforms_;
                if (*language_.texture_parameter) {
                    for (const ShaderTexture& texture : textures_)
                        arguments.push_back(texture.name);
                }
                begin(language_.color, name_, parameters(language_.color, "scene", arguments));
                print_steps("scene");
                line("return c;");
                return end();
            }
            case LanguageFacts::Entry::pointers: {
                std::vector<std::string> all = {"const float in[3]"};
                for (const std::string& uniform : uniforms_)
                    all.push_back(declared(language_.number, uniform));
                all.emplace_back("float out[3]");
                begin("void", name_, all);
                print_steps(made({"in[0]", "in[1]", "in[2]"}));
                for (std::size_t i = 0; i < 3; ++i)
                    line(fmt::format("out[{}] = c{};", i, language_.channel[i]));
                return end();
            }
            case LanguageFacts::Entry::shader: {
                std::vector<std::string> all = {"color Cin = color(0)"};
                for (const std::string& uniform : uniforms_)
                    all.push_back(fmt::format("float {} = 0", uniform));
                all.emplace_back("output color Cout = color(0)");
                text_ +=
                    fmt::format("\nshader {}(\n    {}) {{\n", name_, fmt::join(all, ",\n    "));
                print_steps("Cin");
                line("Cout = c;");
                return end();
            }
        }
    }

    const ShaderProgram& program_;
    const LanguageFacts& language_;
    std::string name_;
    std::vector<std::string> uniforms_;
    ShaderTables tables_;
    std::map<const void*, TableText> table_texts_;
    std::map<std::pair<Table::Interpolation, std::vector<double>>, Search> searches_;
    /// Patterns with {i} of a number in the texture of tables, by all numbers of the array.
    std::map<std::vector<double>, std::string> fetches_;
    std::vector<ShaderTexture> textures_;
    std::string text_;
};

}  // namespace

PrintedProgram print_program(const ShaderProgram& program, const LanguageFacts& language,
                             const std::string& name, const std::vector<std::string>& uniforms,
                             ShaderTables tables) {
    return ProgramPrinter(program, language, name, uniforms, tables).print();
}

TONEWRIGHT_NAMESPACE_END
