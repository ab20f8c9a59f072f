// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Compiles and runs shader functions of one language on this machine.
class TONEWRIGHT_API ShaderRun {
  public:
    ShaderRun() = default;
    ShaderRun(const ShaderRun&) = delete;
    ShaderRun& operator=(const ShaderRun&) = delete;
    virtual ~ShaderRun() = default;

    /// The compiler or driver.
    [[nodiscard]] virtual std::string by() const = 0;

    /// Interleaved RGB.
    /// @param shader  its function has no arguments but the color
    /// @throws Error  the text does not compile, or the driver fails
    virtual void run_rgb(const Shader& shader, const float* in, float* out,
                         std::size_t pixel_count) = 0;
};

struct LanguageRun {
    ShaderLanguageInfo language;
    std::shared_ptr<ShaderRun> run;
};

/// Backends and samples of a comparison with the reference.
struct VerifyOptions {
    /// Empty: every operator, preset and look; with a config, the operators of its views.
    std::vector<ResolvedOperator> operators;
    /// Empty: sRGB; with a config and without operators: all displays of the config.
    std::vector<std::string> displays;
    std::string input = "lin_rec709";
    /// A config to check, or its folder. Empty: a new config in a temporary folder.
    std::string config;
    /// Grid points a side of the gamut grids.
    int gamut_grid_size = 33;
    /// Random colors; colors near black and with negative channels are in proportion.
    std::size_t random_count = 100000;
    /// Includes OpenColorIO's GPU path.
    bool with_gpu = true;
    /// Compares shaders in these languages. The library starts no compiler: applications bring
    /// their runs. Empty: no shaders.
    std::vector<LanguageRun> shaders;
    /// Measures the SIMD engine only with the best instruction set of this processor.
    bool only_best_target = false;
    /// Scene-linear RGB pixels to add to the sample set, in the input space.
    std::vector<float> picture;
    /// Folder that keeps fitted 3D LUTs, at most 256 MiB; empty: nothing is stored.
    std::string cache_folder;
    /// Receives the number of compared views and of all views.
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Errors of one backend of one view against the double reference, in display code values.
struct ParityRow {
    std::string op;
    std::string display;
    /// "simd AVX3", "ocio cpu lossless", "ocio cpu default", "ocio gpu", or a shader's language
    std::string backend;
    /// For OpenColorIO: "config" or "chain", and the operations. For shaders: compiler or driver.
    std::string lowering;
    /// Over colors with all channels >= 0.
    double max = 0, p999 = 0, mean = 0;
    /// Over all colors, also negatives and mixed signs of thousands.
    double max_all = 0;
    /// The largest error of the colors beyond the bound; 0 if there are none. Near black of a
    /// display with a pure power, it is an error of light (times 12.92, sRGB's slope there),
    /// because the code value's own slope is infinite. With the mixed metric, only the error beyond
    /// float32 rounding counts. Float32 rounding is the change of the exact result if each channel
    /// of the input, and of the input of each matrix with negative coefficients, moves by one
    /// float32 unit (2^-23 of its value; 2^-21 for the GPU, whose texture filtering rounds more
    /// often). Such matrices cancel, which no float32 backend can avoid.
    double max_beyond_rounding = 0;
    double bound = 0;
    /// True if a matrix of the chain has negative coefficients.
    bool is_mixed_metric = false;
    /// Every output is finite and inside [0, 1], also for NaN and infinities. Shaders are not
    /// tested with NaN, because compilers may assume that there is none.
    bool is_total = true;
    bool is_ok = true;
    std::string note;  // why a backend is missing, or the worst color of a failure
};

/// @throws Error  a local operator; unknown displays and spaces; FileError for the config folder
[[nodiscard]] TONEWRIGHT_API std::vector<ParityRow> verify(
    const VerifyOptions& options, const std::function<void(const ParityRow&)>& on_row = {});

/// Lines of a table for the terminal: the heading, and a row.
[[nodiscard]] TONEWRIGHT_API std::string parity_heading();
[[nodiscard]] TONEWRIGHT_API std::string format_row(const ParityRow& row);

TONEWRIGHT_NAMESPACE_END
