// SPDX-License-Identifier: Apache-2.0
//
// Camera response: the measured response of a film or a camera to light, from a file.
//
// Source    M. D. Grossberg, S. K. Nayar, "What is the Space of Camera Response Functions?",
//           CVPR 2003, and its database of response functions (DoRF), Columbia University; used as
//           a tone curve by 64, "Tone Mapping", 64.github.io ("ISO").
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives clamped at
//           0. `iso` is the scene value of irradiance 1 of the curve; the curve is constant above
//           it.
// Out       code values in [0, 1]: a response is the pixel value that the camera writes. It is not
//           encoded again; other displays decode it with the power 2.2.
// Kind      per channel, straight lines between the measured points; monotone (the reader refuses
//           curves that fall).
// Keeps     the first and the last value of the file; of the built-in curve 0 -> 0, iso -> 1.
// Built in  no measured curve, because the database does not state terms of redistribution. Without
//           a file the curve is synthetic: I(B) = (1 - exp(-3 B^0.7)) / (1 - exp(-3)) at the 1024
//           irradiances i/1023, with straight lines between them.
// Differs   from the program of 64.github.io, which has four errors. It uses the end of an interval
//           as its start (the result of upper_bound) and extrapolates from the next interval, an
//           error of up to 1.04e-4. It divides 0 by 0 in the last interval. At iso it reads past
//           the table. It encodes the pixel values again with the sRGB curve. Its table is the red
//           curve of dscs315-1 for all channels: curve=red of a four-column file.
// Check     mid gray 0.18 -> 0.239063797 (python_check/operators/camera_response.py).
#include <cmath>

#include "operators/camera_response/response_curve.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::shared_ptr<const Table> synthetic_curve() {
    static const std::shared_ptr<const Table> curve = [] {
        constexpr int kSamples = 1024;
        auto table = std::make_shared<Table>();
        for (int i = 0; i < kSamples; ++i) {
            const double b = static_cast<double>(i) / (kSamples - 1);
            table->samples.push_back((1 - std::exp(-3 * std::pow(b, 0.7))) / (1 - std::exp(-3.0)));
        }
        return table;
    }();
    return curve;
}

ResponseCurves curves_of(const Params& p) {
    const std::string& file = p.text("file");
    const std::string& curve = p.text("curve");
    if (!file.empty()) {
        try {
            return read_response_curves(file, curve);
        } catch (const FileError& e) {
            throw FileError(std::string("camera_response: ") + e.what());
        }
    }
    if (!curve.empty()) throw Error("curve is " + curve + "; expected a file that has it");
    return {synthetic_curve(), synthetic_curve(), synthetic_curve()};
}

}  // namespace

std::vector<Operator> define_camera_response() {
    Operator op;
    op.id = "camera_response";
    op.title = "Camera response (DoRF)";
    op.view = "Camera Response";
    op.character =
        "measured curve of a film or camera from a file, hard white at iso; the built-in curve is "
        "bright and flat";
    op.source =
        "M. Grossberg, S. Nayar, What is the Space of Camera Response Functions?, CVPR 2003; 64, "
        "Tone Mapping, 64.github.io";
    op.license = "published method; no measured curves are included";
    op.bounds = {.ocio_cpu = 1e-6,
                 .ocio_gpu = 3e-6,
                 .reason = "straight lines between the samples, so the slope jumps at each sample"};
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.parameters = fixed_parameters({
        text_parameter(
            "file", "response curves: .rf, CSV or DoRF's text (empty: a built-in synthetic curve)"),
        text_parameter("curve",
                       "curve of a DoRF file: its name, or the common start of three channels' "
                       "names; of a file with four columns: red, green or blue for all channels"),
        number_parameter("iso", "scene-linear", 6, 1e-5, 65504,
                         "scene value of irradiance 1, shown at the end of the curve"),
    });
    op.warnings = {
        "the response already encodes: its code values are not encoded again; for other displays "
        "they are decoded with the power 2.2",
        "the built-in curve is synthetic: no film or camera has it"};
    op.build = [](const Params& p) -> Pipeline {
        const double iso = p.number("iso");
        const ResponseCurves curves = curves_of(p);
        const Expr x = Expr::input() / iso;
        return {ClampStage{0, iso},
                CurveStage{{lookup(curves[0], x), lookup(curves[1], x), lookup(curves[2], x)},
                           std::nullopt}};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
