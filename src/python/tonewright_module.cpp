// SPDX-License-Identifier: Apache-2.0
//
// The Python module `tonewright`.
//
// OpenImageIO's own Python module and this one know each other's types (pybind11 shares them where
// both were built with the same of it), so that an ImageBuf of the one goes into the other.
#include <OpenImageIO/imagebuf.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "image/lut_picture.h"
#include "image/tonemap_arguments.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

namespace py = pybind11;

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;

/// As the command line has it.
std::string text_of(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "yes" : "no";
    return py::str(value);
}

/// `settings` is a dictionary of the operator's parameters.
TonemapOptions parse_options(const std::string& op, const py::kwargs& arguments) {
    TonemapOptions options;
    options.op = op;
    for (const auto& [key, value] : arguments) {
        const std::string name = py::str(key);
        if (name != "settings") {
            set_tonemap_argument(options, name, text_of(value));
            continue;
        }
        if (value.is_none()) continue;
        for (const auto& [parameter, number] : value.cast<py::dict>())
            options.settings[py::str(parameter)] = py::str(number);
    }
    return options;
}

OIIO::TypeDesc pixel_type_of(const py::array& array) {
    const py::dtype type = array.dtype();
    const bool is_native = type.attr("isnative").cast<bool>();
    const std::pair<char, int> kind = {type.kind(), static_cast<int>(type.itemsize())};
    using Type = OIIO::TypeDesc;
    for (const auto& [known, pixel_type] : {std::pair(std::pair('f', 2), Type(Type::HALF)),
                                            std::pair(std::pair('f', 4), Type(Type::FLOAT)),
                                            std::pair(std::pair('f', 8), Type(Type::DOUBLE)),
                                            std::pair(std::pair('u', 1), Type(Type::UINT8)),
                                            std::pair(std::pair('u', 2), Type(Type::UINT16)),
                                            std::pair(std::pair('u', 4), Type(Type::UINT32))}) {
        if (known == kind && is_native) return pixel_type;
    }
    throw Error("tonemap: array is of " + py::str(py::handle(type)).cast<std::string>() +
                "; expected float16, float32, float64, uint8, uint16 or uint32");
}

/// Calls a Python function from any thread, and stops where it raises.
class PythonProgress {
  public:
    explicit PythonProgress(py::object function) : function_(std::move(function)) {}

    [[nodiscard]] OIIO::ProgressCallback callback() const {
        return function_.is_none() ? nullptr : &PythonProgress::call;
    }
    /// What it raised goes on.
    void check() {
        if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    }

  private:
    static bool call(void* self, float part) {
        const py::gil_scoped_acquire lock;
        auto& progress = *static_cast<PythonProgress*>(self);
        try {
            return py::bool_(progress.function_(part));
        } catch (...) {
            progress.error_ = std::current_exception();
            return true;
        }
    }

    py::object function_;
    std::exception_ptr error_;
};

ImageBuf tonemap_picture(const ImageBuf& source, const TonemapOptions& options, OIIO::ROI roi,
                         int nthreads, const py::object& progress) {
    PythonProgress told(progress);
    ImageBuf result;
    bool is_done = false;
    {
        const py::gil_scoped_release release;
        is_done = tonemap(result, source, options, roi, nthreads, told.callback(), &told);
    }
    told.check();
    if (!is_done && !source.initialized()) throw FileError(result.geterror());
    if (!is_done) throw Error(result.geterror());
    return result;
}

py::array tonemap_array(const py::array& given, const TonemapOptions& options, int nthreads,
                        const py::object& progress) {
    const OIIO::TypeDesc type = pixel_type_of(given);
    const py::array array = py::array::ensure(given, py::array::c_style);
    if (!array || array.ndim() < 2 || array.ndim() > 3 || array.size() == 0)
        throw Error("tonemap: array has the shape " + std::string(py::str(given.attr("shape"))) +
                    "; expected (height, width) or (height, width, channels)");
    const auto count = static_cast<int>(array.ndim() == 3 ? array.shape(2) : 1);
    ImageSpec spec(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), count, type);
    if (count == 2) {
        spec.channelnames = {"Y", "A"};
        spec.alpha_channel = 1;
    }
    // The pixels are only read.
    const ImageBuf source(spec, const_cast<void*>(array.data()));
    const ImageBuf result = tonemap_picture(source, options, {}, nthreads, progress);
    std::vector<py::ssize_t> shape = {array.shape(0), array.shape(1)};
    if (array.ndim() == 3 || result.nchannels() > 1) shape.push_back(result.nchannels());
    py::array_t<float> pixels(shape);
    result.get_pixels(result.roi(), OIIO::TypeFloat, pixels.mutable_data());
    return pixels;
}

py::object tonemap_any(const py::object& image, const std::string& op, const py::object& roi,
                       int nthreads, const py::object& progress, const py::kwargs& arguments) {
    const TonemapOptions options = parse_options(op, arguments);
    if (py::isinstance<ImageBuf>(image)) {
        return py::cast(tonemap_picture(image.cast<const ImageBuf&>(), options,
                                        roi.is_none() ? OIIO::ROI() : roi.cast<OIIO::ROI>(),
                                        nthreads, progress));
    }
    if (!py::isinstance<py::array>(image)) {
        throw py::type_error("tonemap: image is a " +
                             std::string(py::str(py::type::of(image).attr("__name__"))) +
                             "; expected a numpy array or an OpenImageIO.ImageBuf");
    }
    if (!roi.is_none()) throw Error("tonemap: roi is given for an array; expected an ImageBuf");
    return tonemap_array(image.cast<py::array>(), options, nthreads, progress);
}

/// The last axis is red, green, blue.
template <class Value>
py::array_t<Value> checked_colors(const py::object& given) {
    py::array_t<Value, py::array::c_style | py::array::forcecast> colors(given);
    if (colors.ndim() < 1 || colors.shape(colors.ndim() - 1) != 3) {
        throw Error("evaluate: colors have the shape " +
                    std::string(py::str(colors.attr("shape"))) + "; expected (..., 3)");
    }
    return colors;
}

py::array evaluate_colors(const std::string& op, const py::object& colors,
                          const py::kwargs& arguments) {
    const TonemapOptions options = parse_options(op, arguments);
    const SourceColor input =
        find_source_color(options.input == kAutoInput ? "lin_rec709" : options.input);
    const View view = make_view(resolve_operator(options.op, options.settings, options.look), input,
                                options.exposure_stops, options.display, options.reference_white);
    const bool is_float = py::isinstance<py::array_t<float>>(colors);
    if (is_float) {
        const py::array_t<float> from = checked_colors<float>(colors);
        py::array_t<float> to(std::vector<py::ssize_t>(from.shape(), from.shape() + from.ndim()));
        const float* in = from.data();
        float* out = to.mutable_data();
        const auto count = static_cast<std::size_t>(from.size()) / 3;
        const py::gil_scoped_release release;
        SimdEngine(build_view(view), view.op.op->bounds.simd_goal).run_rgb(in, out, count);
        return to;
    }
    const py::array_t<double> from = checked_colors<double>(colors);
    py::array_t<double> to(std::vector<py::ssize_t>(from.shape(), from.shape() + from.ndim()));
    const double* in = from.data();
    double* out = to.mutable_data();
    const auto count = static_cast<std::size_t>(from.size()) / 3;
    const py::gil_scoped_release release;
    const ReferenceEngine engine(build_view(view));
    for (std::size_t i = 0; i < count; ++i) {
        const Vector3 rgb = engine({in[3 * i], in[3 * i + 1], in[3 * i + 2]});
        std::copy(rgb.begin(), rgb.end(), out + 3 * i);
    }
    return to;
}

py::dict describe(const ParameterSpec& p) {
    py::dict d;
    d["name"] = p.name;
    d["unit"] = p.unit;
    d["help"] = p.help;
    if (p.kind == ParameterSpec::Kind::number) {
        d["default"] = p.default_value;
        d["min"] = p.min;
        d["max"] = p.max;
    } else {
        d["default"] = p.default_choice;
        if (p.kind == ParameterSpec::Kind::choice) d["choices"] = p.choices;
    }
    if (p.from_picture) d["statistic"] = p.statistic;
    return d;
}

py::list list_operators() {
    py::list all;
    for (const Operator& op : all_operators()) {
        py::list parameters;
        for (const ParameterSpec& p : op.parameters)
            parameters.append(describe(p));
        py::dict presets;
        for (const Preset& preset : op.presets)
            presets[py::str(preset.id)] = preset.settings;
        py::dict looks;
        for (const Look& look : op.looks)
            looks[py::str(look.id)] = look.help;
        py::dict d;
        d["id"] = op.id;
        d["title"] = op.title;
        d["view"] = op.view;
        d["character"] = op.character;
        d["source"] = op.source;
        d["parameters"] = parameters;
        d["presets"] = presets;
        d["looks"] = looks;
        all.append(d);
    }
    return all;
}

py::dict bake_file(const std::string& op, const std::string& file, const std::string& host,
                   std::optional<std::string> format, std::optional<std::string> input_encoding,
                   std::optional<int> size, std::optional<int> depth, const py::kwargs& arguments) {
    TonemapOptions options = parse_options(op, arguments);
    const LutApplication* reader = host.empty() ? nullptr : &find_lut_application(host);
    LutRequest request;
    request.format =
        parse_lut_format(format.value_or(reader ? name_of(reader->format) : std::string("cube")));
    request.encoding =
        parse_input_encoding(input_encoding.value_or(reader ? reader->encoding : "acescct"));
    if (options.input == kAutoInput) options.input = request.encoding.default_input;
    if (reader && !arguments.contains("display")) options.display = reader->display;
    if (reader && !format) {
        request.size = reader->size;
        request.bits = reader->bits;
        request.dimension = LutDimension::three;
    }
    if (size) request.size = size;
    if (depth) request.bits = depth;
    request.view =
        make_view(resolve_operator(options.op, options.settings, options.look), options.input,
                  options.exposure_stops, options.display, options.reference_white);
    BakedLut baked;
    {
        const py::gil_scoped_release release;
        baked = bake_lut(request, LutNodes::automatic, reader && is_trilinear(*reader));
        request.size = baked.lut.size;
        if (is_picture_format(request.format)) {
            const int bits = request.bits.value_or(16);
            OIIO::TypeDesc type = OIIO::TypeFloat;
            if (bits == 8) type = OIIO::TypeUInt8;
            if (bits == 16) type = OIIO::TypeUInt16;
            write_image_atomically(make_lut_picture(baked.lut, request.format), file, type);
        } else {
            write_text_atomically(file,
                                  write_lut(baked.lut, request, baked.error, baked.other_error));
        }
    }
    py::dict result;
    result["dimension"] = baked.lut.dimension;
    result["size"] = baked.lut.size;
    result["max_error"] = baked.error.max;
    result["mean_error"] = baked.error.mean;
    result["interpolation"] = baked.error.interpolation;
    return result;
}

constexpr const char* kOptions = R"(
Keyword options, as on the command line:
  settings         dict of the operator's parameters, see operators()
  exposure         stops before the operator (0)
  input            "auto", a scene-linear space ("lin_ap1"), or an encoding ("sRGB", "Gamma2.2")
  display          "srgb", "rec1886", "rec2100_pq", ..., "linear" or "native"
  look             look of the operator
  reference_white  what an HDR display shows light 1 at, cd/m2 (100)
)";

}  // namespace
TONEWRIGHT_NAMESPACE_END

PYBIND11_MODULE(tonewright, m) {
    namespace tw = tonewright;
    m.doc() = "Tone mapping operators: pictures, colors and lookup tables.";

    py::register_exception_translator([](std::exception_ptr error) {
        try {
            if (error) std::rethrow_exception(error);
        } catch (const tw::FileError& e) {
            PyErr_SetString(PyExc_OSError, e.what());
        } catch (const tw::Error& e) {
            PyErr_SetString(PyExc_ValueError, e.what());
        }
    });

    static const std::string tonemap_doc =
        std::string(R"(Tone maps a picture into a new one of floats.

image: an OpenImageIO.ImageBuf, or a numpy array of shape (height, width) or (height, width,
channels): float16, float32, float64, or uint8, uint16, uint32, which stand for [0, 1]. The first
three channels are color (or the first of one or two), the fourth (second) is alpha, with which
color is multiplied unless `unpremult` is "no".
op: operator id, optionally with :preset.

Returns what it was given: an ImageBuf or an array of float32.
Raises ValueError for options or pictures that cannot be, OSError for files.
)") + tw::kOptions +
        R"(  unpremult        "auto", "yes" or "no": divide color by alpha before
  statistics       "picture" or "defaults": parameters that a picture has
  roi              OpenImageIO.ROI, of an ImageBuf
  nthreads         0: all
  progress         called with the part that is done; True stops

Example: tonewright.tonemap(OpenImageIO.ImageBuf("shot.exr"), "agx_blender", exposure=1)
)";
    m.def("tonemap", &tw::tonemap_any, py::arg("image"), py::arg("op"), py::kw_only(),
          py::arg("roi") = py::none(), py::arg("nthreads") = 0, py::arg("progress") = py::none(),
          tonemap_doc.c_str());
    static const std::string evaluate_doc = std::string(R"(The view's code values of colors.

colors: shape (..., 3). float32 goes through the SIMD engine and comes back as float32; all other
numbers through the double-precision reference, as float64. There is no picture: parameters that one
has have their defaults.
)") + tw::kOptions + "\nExample: tonewright.evaluate(\"hable\", [0.18, 0.18, 0.18])\n";
    m.def("evaluate", &tw::evaluate_colors, py::arg("op"), py::arg("colors"), evaluate_doc.c_str());
    m.def("operators", &tw::list_operators,
          "All operators: a list of dicts with id, title, parameters, presets, looks, source.");
    static const std::string bake_doc =
        std::string(R"(Writes a lookup table, and returns its size and measured error.

file: replaced only when the new one is whole.
host: application that reads it ("resolve"; `tonewright list --hosts`): format, size, input and
display are then what it expects, unless given.
format, input_encoding, size, depth: as those of `tonewright bake`.
)") + tw::kOptions +
        "\nExample: tonewright.bake(\"agx_blender\", \"agx.cube\", host=\"resolve\")\n";
    m.def("bake", &tw::bake_file, py::arg("op"), py::arg("file"), py::kw_only(),
          py::arg("host") = "", py::arg("format") = py::none(),
          py::arg("input_encoding") = py::none(), py::arg("size") = py::none(),
          py::arg("depth") = py::none(), bake_doc.c_str());
}
