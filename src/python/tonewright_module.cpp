// SPDX-License-Identifier: Apache-2.0
//
// The compiled part of the Python module `tonewright`. Its __init__.py has the public functions:
// they check types, so that wrong calls raise Python's usual exceptions, and pass options by name.
//
// OpenImageIO's own Python module and this one share their types if both were built with the same
// pybind11. Functions here then accept an ImageBuf of OpenImageIO's module.
#include <OpenImageIO/imagebuf.h>
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/lut_picture.h"
#include "image/resize.h"
#include "image/scene_meter.h"
#include "image/source_picture.h"
#include "image/tonemap_arguments.h"
#include "image/tonemap_file.h"
#include "picture/picture_error.h"
#include "picture/row_fitter.h"
#include "shader_runs/shader_run.h"
#include "tasks/bake.h"
#include "tasks/config.h"
#include "tasks/json_forms.h"
#include "tasks/pictures/apply.h"
#include "tasks/pictures/frames.h"
#include "tasks/pictures/metering.h"
#include "tasks/pictures/read_picture.h"
#include "tasks/verify.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/lut_file.h"
#include "tonewright/meter.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

namespace py = pybind11;

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;

/// Text of a value, as it would be on the command line.
std::string text_of(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "yes" : "no";
    std::string text = py::str(value);
    // A zero byte ends texts for the system and in messages.
    if (text.find('\0') != std::string::npos) throw py::value_error("embedded null character");
    return text;
}

bool is_number(std::string_view text) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

/// A parameter of the library as an argument of this module's functions.
std::string argument_of(std::string_view parameter) {
    for (const auto& [field, argument] :
         {std::pair("application", "host"), std::pair("low_percentile", "low"),
          std::pair("high_percentile", "high"), std::pair("pixel_type", "dtype"),
          std::pair("type", "dtype"), std::pair("in", "source"), std::pair("out", "target"),
          std::pair("frames_per_second", "fps")}) {
        if (parameter == field) return argument;
    }
    return std::string(parameter);
}

/// Messages write parameters as arguments: `size is 3`, `size=65`.
constexpr MessageStyle kStyle = {
    argument_of, [](std::string_view parameter, std::string_view value) {
        if (parameter == "task") return std::string(value == "apply" ? "tonemap()" : value);
        if (parameter == "list") {
            return value == "operators" ? "operators()"
                                        : fmt::format("`tonewright list --{}`", value);
        }
        if (parameter == "settings") return fmt::format("settings={{\"{}\": ...}}", value);
        if (parameter == "custom" && !value.empty())
            return fmt::format("custom={{VIEW: \"{}\"}}", value);
        const std::string argument = argument_of(parameter);
        if (value == "yes") return argument + "=True";
        if (parameter == "dimension") value = value.substr(0, 1);  // 3 of "3d"
        if (value.empty() || is_number(value)) return fmt::format("{}={}", argument, value);
        return fmt::format("{}=\"{}\"", argument, value);
    }};

/// A message, which may name a file whose name is no UTF-8.
py::str text_from(const std::string& message) {
    return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(
        message.data(), static_cast<py::ssize_t>(message.size()), "backslashreplace"));
}

/// The name of a file, as os.fsdecode() has it.
py::str path_text(const std::string& path) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeFSDefaultAndSize(path.data(), static_cast<py::ssize_t>(path.size())));
}

/// A UserWarning at the line that called the package's function.
/// @throws py::error_already_set  Python's filters make it an error.
void warn(const std::string& text) {
    constexpr Py_ssize_t kCallerOfPackage = 2;
    const py::gil_scoped_acquire acquire;
    const py::str message = text_from(one_line(render(text, kStyle)));
    if (PyErr_WarnEx(PyExc_UserWarning, PyUnicode_AsUTF8(message.ptr()), kCallerOfPackage) != 0)
        throw py::error_already_set();
}

PyObject* exception_of(const Problem& problem) {
    switch (problem.kind) {
        case Problem::Kind::memory:
            return PyExc_MemoryError;
        case Problem::Kind::file:
            break;
        case Problem::Kind::internal:
            return PyExc_RuntimeError;
        default:
            return PyExc_ValueError;
    }
    switch (problem.error_number) {
        case ENOENT:
            return PyExc_FileNotFoundError;
        case EACCES:
            return PyExc_PermissionError;
        case EISDIR:
            return PyExc_IsADirectoryError;
        default:
            return PyExc_OSError;
    }
}

void set_error(const Problem& problem) {
    PyErr_SetObject(exception_of(problem), text_from(one_line(render(problem, kStyle))).ptr());
}

/// The reader of .tone files and LUTs.
const OperatorSet& operator_files() {
    static const OperatorSet files(table_reader(picture_table_reader(ocio_table_reader())),
                                   OperatorSet::Formulas::yes);
    return files;
}

/// `settings` is a dictionary of the operator's parameters.
TonemapOptions parse_options(const std::string& op, const py::kwargs& arguments) {
    TonemapArguments texts;
    texts.op = text_of(py::str(op));
    for (const auto& [key, value] : arguments) {
        const std::string name = py::str(key);
        if (name != "settings") {
            set_tonemap_argument(texts, name, text_of(value));
            continue;
        }
        if (value.is_none()) continue;
        for (const auto& [parameter, number] : value.cast<py::dict>())
            texts.settings[text_of(parameter)] = text_of(number);
    }
    TonemapOptions options = resolve_arguments(texts, operator_files());
    const std::string caution = options.op.caution();
    if (!caution.empty()) warn(caution);
    return options;
}

/// The same, for what is not a picture.
/// @throws Error  a local operator
TonemapOptions parse_color_options(const std::string& op, const py::kwargs& arguments) {
    TonemapOptions options = parse_options(op, arguments);
    require_no_surroundings(*options.op.op);
    return options;
}

OIIO::TypeDesc pixel_type_of(const char* function, const py::array& array) {
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
    throw Error(std::string(function) + ": array is of " +
                py::str(py::handle(type)).cast<std::string>() +
                "; expected float16, float32, float64, uint8, uint16 or uint32");
}

/// Calls a Python function from any thread, and stops if it raises.
class PythonProgress {
  public:
    explicit PythonProgress(py::object function) : function_(std::move(function)) {}

    [[nodiscard]] OIIO::ProgressCallback callback() const {
        return function_.is_none() ? nullptr : &PythonProgress::call;
    }
    /// Its Python exception continues.
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

/// @param resize  @see ReadOptions::resize
ImageBuf tonemap_picture(const ImageBuf& given, const TonemapOptions& options,
                         const std::string& resize, OIIO::ROI roi, int nthreads,
                         const py::object& progress) {
    PythonProgress told(progress);
    ImageBuf light;
    if (!resize.empty()) {
        const py::gil_scoped_release release;
        try {
            check_source(given);
            light = with_memory_for("tonemap", [&] {
                return resized_picture(given, resize, options, kMaxPixels, nthreads);
            });
        } catch (const PictureError& e) {
            throw Error(std::string("tonemap: ") + e.what());
        }
    }
    const ImageBuf& source = resize.empty() ? given : light;
    ImageBuf result;
    try {
        const py::gil_scoped_release release;
        with_memory_for("tonemap", [&] {
            Tonemapper(options).run(result, source, roi, nthreads, told.callback(), &told);
        });
    } catch (const Error& e) {
        told.check();
        Problem problem = e.problem();
        // A picture in memory is an argument.
        if (problem.kind == Problem::Kind::file && source.initialized())
            problem.kind = Problem::Kind::usage;
        if (problem.kind == Problem::Kind::usage && !source.initialized())
            problem.kind = Problem::Kind::file;
        throw Error(problem);
    }
    told.check();
    return result;
}

/// A picture that is a view of an array's memory.
struct ArrayPicture {
    /// Contiguous: the given array, or a copy.
    py::array array;
    ImageBuf picture;
};

ArrayPicture picture_of(const char* function, const py::array& given) {
    const OIIO::TypeDesc type = pixel_type_of(function, given);
    py::array array = py::array::ensure(given, py::array::c_style);
    const std::string shape = py::str(given.attr("shape"));
    if (!array || array.ndim() < 2 || array.ndim() > 3 || array.size() == 0) {
        throw Error(std::string(function) + ": array has the shape " + shape +
                    "; expected (height, width) or (height, width, channels)");
    }
    const auto count = static_cast<int>(array.ndim() == 3 ? array.shape(2) : 1);
    // Channels first, as in PyTorch: such an array looks like a picture of three rows.
    if (count > 4 && (array.shape(0) == 3 || array.shape(0) == 4)) {
        throw Error(std::string(function) + ": array has the shape " + shape +
                    "; expected (height, width, channels), or axis=0");
    }
    ImageSpec spec(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), count, type);
    if (count == 2) {
        spec.channelnames = {"Y", "A"};
        spec.alpha_channel = 1;
    }
    // The pixels are only read.
    ImageBuf picture(spec, const_cast<void*>(array.data()));
    return {std::move(array), std::move(picture)};
}

py::array tonemap_array(const py::array& given, const TonemapOptions& options,
                        const std::string& resize, int nthreads, const py::object& progress) {
    const auto [array, source] = picture_of("tonemap", given);
    const ImageBuf result = tonemap_picture(source, options, resize, {}, nthreads, progress);
    std::vector<py::ssize_t> shape = {result.spec().height, result.spec().width};
    if (array.ndim() == 3 || result.nchannels() > 1) shape.push_back(result.nchannels());
    py::array_t<float> pixels(shape);
    result.get_pixels(result.roi(), OIIO::TypeFloat, pixels.mutable_data());
    return pixels;
}

py::object tonemap_any(const py::object& image, const std::string& op, const py::object& roi,
                       int nthreads, const py::object& progress, const std::string& resize,
                       const py::kwargs& arguments) {
    if (!resize.empty()) (void)parse_resize(resize);  // a wrong text
    if (!resize.empty() && !roi.is_none())
        throw Error("tonemap: roi is given with resize; expected one of them");
    const TonemapOptions options = parse_options(op, arguments);
    if (py::isinstance<ImageBuf>(image)) {
        return py::cast(tonemap_picture(image.cast<const ImageBuf&>(), options, resize,
                                        roi.is_none() ? OIIO::ROI() : roi.cast<OIIO::ROI>(),
                                        nthreads, progress));
    }
    if (!py::isinstance<py::array>(image)) {
        throw py::type_error("tonemap: image is a " +
                             std::string(py::str(py::type::of(image).attr("__name__"))) +
                             "; expected a numpy array or an OpenImageIO.ImageBuf");
    }
    if (!roi.is_none()) throw Error("tonemap: roi is given for an array; expected an ImageBuf");
    return tonemap_array(image.cast<py::array>(), options, resize, nthreads, progress);
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
    const TonemapOptions options = parse_color_options(op, arguments);
    const SourceColor input = in_units(
        find_source_color(is_same_name(options.input, kAutoInput) ? "lin_rec709" : options.input),
        options.input_units);
    const View view = make_view(options.op, input, options.exposure_stops, options.display,
                                options.reference_white);
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

/// A JSON value as one of Python.
struct ToPython {
    py::object operator()(const Json& json) const { return std::visit(*this, json.value()); }
    py::object operator()(std::nullptr_t) const { return py::none(); }
    py::object operator()(const Json::Array& elements) const {
        py::list all;
        for (const Json& element : elements)
            all.append((*this)(element));
        return all;
    }
    py::object operator()(const Json::Object& members) const {
        py::dict all;
        for (const auto& [name, value] : members)
            all[py::str(name)] = (*this)(value);
        return all;
    }
    template <class Plain>
    py::object operator()(const Plain& value) const {
        return py::cast(value);
    }
};

py::dict describe(const Operator& op);
py::dict describe(const Display& display);
py::dict describe(const ExtendedView& view);

/// A dict for each value.
template <class Values>
py::list describe_all(const Values& values) {
    py::list all;
    for (const auto& value : values)
        all.append(describe(value));
    return all;
}

py::dict describe(const Operator& op) {
    py::dict presets;
    for (const Preset& preset : op.presets)
        presets[py::str(preset.id)] = preset.settings;
    py::dict looks;
    for (const Look& look : op.looks)
        looks[py::str(look.id)] = look.help;
    py::dict d = ToPython{}(to_json(op));
    d["presets"] = presets;
    d["looks"] = looks;
    return d;
}

py::dict describe(const Display& display) {
    py::dict d = ToPython{}(to_json(display));
    d["hdr"] = display.is_hdr;
    d["peak"] = display.peak;
    return d;
}

py::dict describe(const ExtendedView& view) {
    py::dict d;
    d["display"] = view.display;
    d["view"] = view.view;
    d["max"] = view.max;
    d["p999"] = view.p999;
    return d;
}

py::dict bake_file(const std::string& op, const std::string& file, const std::string& host,
                   const std::optional<std::string>& format,
                   const std::optional<std::string>& input_encoding, std::optional<int> dimension,
                   std::optional<int> size, std::optional<double> max_error,
                   const std::string& nodes, std::optional<int> decimals, std::optional<int> depth,
                   std::optional<int> icc_version, const std::string& cache,
                   const py::kwargs& arguments) {
    const TonemapOptions options = parse_color_options(op, arguments);
    BakeRequest request;
    request.file = file;
    request.op = options.op;
    if (!host.empty()) request.application = &find_lut_application(host);
    if (format) request.format = parse_lut_format(*format);
    if (input_encoding) request.encoding = parse_input_encoding(*input_encoding);
    if (!is_same_name(options.input, kAutoInput)) request.input = &find_input_space(options.input);
    request.input_units = options.input_units;
    request.exposure_stops = options.exposure_stops;
    if (arguments.contains("display")) request.display = options.display;
    request.reference_white = options.reference_white;
    if (dimension) {
        request.dimension = find_choice("dimension", std::to_string(*dimension), {"1", "3"}) == 0
                                ? LutDimension::one
                                : LutDimension::three;
    }
    request.size = size;
    request.depth = depth;
    request.decimals = decimals;
    request.icc_version = icc_version;
    request.max_error = max_error;
    request.nodes = parse_lut_nodes(nodes);
    request.write_picture = write_lut_picture;
    request.cache_folder = cache;
    const BakeResult baked = [&] {
        const py::gil_scoped_release release;
        return bake(request, {.warn = warn});
    }();
    py::dict result;
    // A chain of operations has no one size.
    if (baked.operations.empty()) {
        result["dimension"] = baked.baked.lut.dimension;
        result["size"] = baked.baked.lut.size;
    } else {
        result["operations"] = baked.operations;
    }
    const LutError& error = baked.baked.error;
    const PhotographError& photographs = error.photographs;
    py::dict on_photographs;
    on_photographs["p999"] = photographs.p999;
    on_photographs["mean"] = photographs.mean;
    on_photographs["above_one_code"] = photographs.share;
    on_photographs["outside"] = photographs.outside;
    result["photographs"] = on_photographs;
    result["max_error"] = error.max;
    result["mean_error"] = error.mean;
    result["interpolation"] = error.interpolation;
    result["clipped"] = to_string(baked.clipping);
    py::list steps;
    for (const std::string& line : baked.steps)
        steps.append(render(line, kStyle));
    result["steps"] = steps;
    return result;
}

/// Options for reading, tone mapping and writing picture files.
struct FileOptions {
    TonemapOptions tonemap;
    ReadOptions read;
    WriteOptions write;
    int nthreads = 0;
    bool is_in_place = false;
};

/// @param file  the arguments that concern files; the package checks their types
FileOptions parse_file_options(const std::string& op, const py::dict& file,
                               const py::kwargs& arguments) {
    const auto text = [&](const char* name) { return file[name].cast<std::string>(); };
    FileOptions options;
    options.read.resize = text("resize");
    if (!options.read.resize.empty()) (void)parse_resize(options.read.resize);
    options.read.subimage = text("subimage");
    options.read.layer = text("layer");
    options.tonemap = parse_options(op, arguments);
    WriteOptions& write = options.write;
    if (const auto most = file["max_pixels"].cast<std::optional<double>>())
        options.read.max_pixels = write.max_pixels = *most;
    set_alpha(write, text("alpha"));
    take_alpha(options.tonemap, write);
    if (const std::string type = text("type"); !type.empty()) set_pixel_type(write, type);
    write.compression = text("compression");
    write.quality = file["quality"].cast<int>();
    write.subsampling = text("subsampling");
    write.verifies = file["verify_output"].cast<bool>();
    write.write_provenance = true;
    options.nthreads = file["nthreads"].cast<int>();
    options.is_in_place = file["in_place"].cast<bool>();
    return options;
}

void tonemap_into_file(const std::string& in, const std::string& out, const std::string& op,
                       const py::dict& file, const py::kwargs& arguments) {
    FileOptions options = parse_file_options(op, file, arguments);
    check_overwriting({{in, out}}, options.is_in_place);
    const py::gil_scoped_release release;
    options.write.warn = [&](const std::string& text) { warn(fmt::format("{}: {}", out, text)); };
    options.read.warn = [&](const std::string& text) { warn(fmt::format("{}: {}", in, text)); };
    tonemap_file(Tonemapper(options.tonemap), in, out, options.write, options.read,
                 options.nthreads);
}

/// @param frames  text of parse_frames(), or numbers
std::vector<int> frames_of(const py::handle& frames, const char* parameter) {
    return py::isinstance<py::str>(frames) ? parse_frames(frames.cast<std::string>(), parameter)
                                           : frames.cast<std::vector<int>>();
}

/// @param shot  the arguments that concern the frames and their exposures
py::list tonemap_shot(const std::string& in, const std::string& out, const std::string& op,
                      const py::dict& shot, const py::dict& file, const py::kwargs& arguments) {
    const auto text = [&](const char* name) { return shot[name].cast<std::string>(); };
    FileOptions options = parse_file_options(op, file, arguments);
    // Reports wrong options before the shot is metered.
    (void)PictureWriter(out, options.write);
    ExposureRequest exposure;
    const std::size_t statistics =
        find_choice("statistics", text("statistics"), {"picture", "sequence", "defaults"});
    exposure.takes_sequence = statistics == 1;
    if (statistics == 2) options.tonemap.statistics = TonemapOptions::Statistics::defaults;
    if (const std::string method = text("auto_exposure"); !method.empty()) {
        exposure.rule = ExposureRule{};
        try {
            exposure.rule->method = parse_meter_method(method);
        } catch (const Error& e) {
            Problem problem = e.problem();
            problem.parameter = "auto_exposure";
            throw Error(problem);
        }
        exposure.rule->key = shot["key"].cast<std::optional<double>>();
        exposure.rule->compensation = shot["compensation"].cast<double>();
        check_exposure_rule(*exposure.rule);
    }
    exposure.exposure_stops = options.tonemap.exposure_stops;
    if (shot["adapt"].cast<bool>()) {
        exposure.adaptation = Adaptation{};
        exposure.adaptation->fps = shot["fps"].cast<double>();
        check_adaptation(*exposure.adaptation);
    }
    exposure.meter.options = meter_options(options.tonemap);
    exposure.meter.options.read = options.read;
    exposure.meter.cache = text("meter_cache");
    exposure.meter.work.threads = options.nthreads;
    if (!shot["meter_frames"].is_none())
        exposure.frames = frames_of(shot["meter_frames"], "meter_frames");
    ShotRequest request = {.in = in,
                           .out = out,
                           .numbers = frames_of(shot["frames"], "frames"),
                           .skips_existing = shot["skip_existing"].cast<bool>(),
                           .is_in_place = options.is_in_place};
    request.missing = parse_missing(text("missing"));
    exposure.leaves_out_missing = request.missing != ShotRequest::Missing::error;
    SequenceOptions sequence = {.write = options.write,
                                .skip_existing = request.skips_existing,
                                .jobs = shot["jobs"].cast<int>(),
                                .nthreads = options.nthreads,
                                .read = options.read,
                                .names_pictures = true};
    sequence.write.warn = sequence.read.warn = warn;
    Shot planned;
    {
        const py::gil_scoped_release release;
        Tonemapper tonemapper(options.tonemap);
        planned = plan_shot(request);
        meter_frames(tonemapper, planned, in, exposure, {.warn = warn});
        tonemap_pictures(tonemapper, planned.frames, sequence, 0);
    }
    py::list results;
    for (std::size_t i = 0; i < planned.frames.size(); ++i) {
        const FrameFiles& frame = planned.frames[i];
        py::dict d;
        d["frame"] = planned.numbers[i];
        d["source"] = path_text(frame.in);
        d["target"] = path_text(frame.out);
        d["exposure"] = frame.exposure_stops.value_or(options.tonemap.exposure_stops);
        d["skipped"] = frame.is_skipped;
        d["error"] = py::none();
        if (frame.problem) d["error"] = text_from(one_line(render(*frame.problem, kStyle)));
        results.append(d);
    }
    return results;
}

/// Facts in the header of a picture, with the keys of `tonewright info --json`.
py::dict describe_file(const std::string& path, const std::string& input,
                       const std::string& subimage, const std::string& layer) {
    PictureInfo info;
    {
        const py::gil_scoped_release release;
        info = read_picture_info(path, {.subimage = subimage, .layer = layer}, input);
    }
    PictureDescription& said = info.said;
    for (std::vector<std::string>* texts : {&said.ignored, &info.choices}) {
        for (std::string& text : *texts)
            text = render(text, kStyle);
    }
    const Primaries& p = said.color.primaries;
    py::dict d;
    d["space"] = said.color.name;
    d["transfer"] = said.transfer;
    d["primaries"] = py::make_tuple(p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y);
    d["white"] = py::make_tuple(p.whitepoint.x, p.whitepoint.y);
    d["orientation"] = said.orientation;
    d["layer"] = said.layer;
    d["subimage"] = said.subimage;
    d["units"] = said.units;
    d["alpha"] = said.alpha;
    d["rule"] = render(said.rule, kStyle);
    d["ignored"] = said.ignored;
    d["choices"] = info.choices;
    return d;
}

py::dict describe(const Metering& metering, const ExposureRule& rule, double delta) {
    py::dict d;
    d["pixels"] = metering.counted;
    d["black"] = metering.black;
    d["nan"] = metering.nan;
    d["infinite"] = metering.infinite;
    d["uncovered"] = metering.uncovered;
    d["log_average"] = metering.log_average;
    d["geometric_mean"] = metering.geometric_mean;
    d["mean"] = metering.mean;
    d["minimum"] = metering.minimum;
    d["maximum"] = metering.maximum;
    d["histogram_average"] = metering.histogram_average;
    d["histogram_range"] = py::make_tuple(metering.histogram_min, metering.histogram_max);
    d["outside"] = metering.share_outside();
    py::dict percentiles;
    for (std::size_t i = 0; i < metering.percentiles.size(); ++i)
        percentiles[py::float_(Metering::kPercents[i])] = metering.percentiles[i];
    d["percentiles"] = percentiles;
    const Suggestion suggestion = suggest_exposure(metering, rule, delta);
    d["luminance"] = suggestion.luminance;
    d["ev100"] = suggestion.ev100;
    d["exposure"] = suggestion.stops;
    return d;
}

py::dict meter_any(const py::object& image, const std::string& method, std::optional<double> key,
                   double compensation, double delta, double low, double high,
                   const std::string& input, const std::string& input_units, double reference_white,
                   const std::string& unpremult, const std::string& subimage,
                   const std::string& layer, int nthreads, double max_pixels) {
    TonemapArguments alpha;
    set_tonemap_argument(alpha, "unpremult", unpremult);
    MeterOptions options;
    options.input = input;
    options.input_units = parse_input_units(input_units);
    options.reference_white = reference_white;
    options.unpremult = alpha.others.unpremult;
    options.read = {.subimage = subimage, .layer = layer, .max_pixels = max_pixels};
    options.delta = delta;
    options.low_percentile = low;
    options.high_percentile = high;
    check_meter_options(options);
    ExposureRule rule;
    rule.method = parse_meter_method(method);
    rule.key = key;
    rule.compensation = compensation;
    check_exposure_rule(rule);
    Metering metering;
    if (py::isinstance<ImageBuf>(image)) {
        const auto& picture = image.cast<const ImageBuf&>();
        const py::gil_scoped_release release;
        metering = with_memory_for("meter", [&] { return meter(picture, options, nthreads); });
    } else if (py::isinstance<py::array>(image)) {
        const ArrayPicture pixels = picture_of("meter", image.cast<py::array>());
        const py::gil_scoped_release release;
        metering =
            with_memory_for("meter", [&] { return meter(pixels.picture, options, nthreads); });
    } else if (!py::isinstance<py::bytes>(image)) {
        throw py::type_error("meter: image is a " +
                             std::string(py::str(py::type::of(image).attr("__name__"))) +
                             "; expected a path, a numpy array or an OpenImageIO.ImageBuf");
    } else {
        const auto path = image.cast<std::string>();
        const py::gil_scoped_release release;
        metering = meter_file(path, options, nthreads);
    }
    return describe(metering, rule, delta);
}

using CustomViews = std::vector<std::pair<std::string, std::string>>;

ConfigOptions config_options(const std::vector<std::string>& views,
                             const std::vector<std::string>& displays,
                             const std::vector<std::string>& looks, const CustomViews& custom,
                             const std::vector<double>& exposure_stops, const std::string& cache) {
    ConfigOptions options;
    options.cache_folder = cache;
    options.others = operator_files();
    options.views = views;
    options.displays = displays;
    options.looks = looks;
    options.exposure_stops = exposure_stops;
    for (const auto& [name, op] : custom)
        options.custom.push_back({name, resolve_operator(op, {}, {}, options.others)});
    return options;
}

void make_config_files(const std::string& folder, const std::string& archive,
                       const std::vector<std::string>& profiles, const std::string& working,
                       const std::vector<std::string>& views,
                       const std::vector<std::string>& displays,
                       const std::vector<std::string>& looks, const CustomViews& custom,
                       const std::vector<double>& exposure_stops, const std::string& cache) {
    ConfigRequest request;
    request.options = config_options(views, displays, looks, custom, exposure_stops, cache);
    request.options.profiles = profiles;
    request.options.working = find_input_space(working).id;
    request.folder = folder;
    request.archive = archive;
    const py::gil_scoped_release release;
    write_config(request, {.warn = warn});
}

py::dict change_config_file(const std::string& path, const std::string& kind, bool has_backup,
                            const std::vector<std::string>& views,
                            const std::vector<std::string>& displays,
                            const std::vector<std::string>& looks, const CustomViews& custom,
                            const std::vector<double>& exposure_stops, const std::string& cache) {
    ConfigChange change;
    change.kind =
        static_cast<ConfigChange::Kind>(find_choice("change", kind, {"add", "update", "remove"}));
    change.options = config_options(views, displays, looks, custom, exposure_stops, cache);
    change.has_backup = has_backup;
    change.warn = warn;
    const ChangedConfig changed = [&] {
        const py::gil_scoped_release release;
        return with_memory_for(path, [&] { return change_config(path, change); });
    }();
    py::dict d;
    d["path"] = path_text(changed.path);
    d["backup"] = path_text(changed.backup);
    py::dict added;
    for (const auto& [name, items] : changed.added)
        added[py::str(name)] = items;
    d["added"] = added;
    d["removed_tables"] = changed.removed_tables;
    d["views"] = describe_all(changed.views);
    return d;
}

py::object verify_operators(const std::vector<std::string>& operators,
                            const std::vector<std::string>& displays, const std::string& input,
                            const std::string& config, bool is_quick, bool with_gpu,
                            const std::vector<std::string>& shaders, const std::string& cache) {
    VerifyRequest request = {.is_quick = is_quick};
    VerifyOptions& options = request.options;
    options.cache_folder = cache;
    options.operators = resolve_operators(operators, operator_files());
    options.displays = displays;
    options.input = input;
    options.config = config;
    options.with_gpu = with_gpu;
    options.only_best_target = is_quick;
    const VerifyResult result = [&] {
        const py::gil_scoped_release release;
        return with_memory_for(config.empty() ? "verify" : config, [&] {
            add_shader_runs(options, shaders);
            return verify(request);
        });
    }();
    return ToPython{}(all_to_json(result.rows));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END

PYBIND11_MODULE(_tonewright, m) {
    namespace tw = tonewright;
    // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 calls it with a copy.
    py::register_exception_translator([](std::exception_ptr error) {
        try {
            if (error) std::rethrow_exception(error);
        } catch (const tw::Error& e) {
            tw::set_error(e.problem());
        } catch (const std::bad_alloc&) {
            PyErr_SetString(PyExc_MemoryError, "not enough memory");
        }
    });
    m.attr("__version__") = TONEWRIGHT_VERSION;
    m.def("tonemap", &tw::tonemap_any, py::arg("image"), py::arg("op"), py::kw_only(),
          py::arg("roi"), py::arg("nthreads"), py::arg("progress"), py::arg("resize"));
    m.def("tonemap_file", &tw::tonemap_into_file, py::arg("source"), py::arg("target"),
          py::arg("op"), py::kw_only(), py::arg("file"));
    m.def("tonemap_frames", &tw::tonemap_shot, py::arg("source"), py::arg("target"), py::arg("op"),
          py::kw_only(), py::arg("shot"), py::arg("file"));
    m.def("evaluate", &tw::evaluate_colors, py::arg("op"), py::arg("colors"));
    m.def("meter", &tw::meter_any);
    m.def("info", &tw::describe_file, py::arg("image"), py::arg("input"), py::arg("subimage"),
          py::arg("layer"));
    m.def("operators", [] { return tw::describe_all(tw::all_operators()); });
    m.def("displays", [] { return tw::describe_all(tw::all_displays()); });
    m.def("applications",
          [] { return tw::ToPython{}(tw::all_to_json(tw::all_lut_applications(), tw::kStyle)); });
    m.def("bake", &tw::bake_file, py::arg("op"), py::arg("file"), py::kw_only(), py::arg("host"),
          py::arg("format"), py::arg("input_encoding"), py::arg("dimension"), py::arg("size"),
          py::arg("max_error"), py::arg("nodes"), py::arg("decimals"), py::arg("depth"),
          py::arg("icc_version"), py::arg("cache"));
    m.def("make_config", &tw::make_config_files);
    m.def("change_config", &tw::change_config_file);
    m.def("verify", &tw::verify_operators);
}
