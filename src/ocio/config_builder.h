// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "ocio/lut_files.h"
#include "ocio/model.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The view transform that a view takes on a display.
struct DisplayedView {
    std::string transform;
    Pipeline stages;
    const Display* display;
    /// What the view is called on the display.
    std::string name;
    ResolvedOperator op;
};

/// One view transform for all displays that it is the same for. "AgX", or where there are several,
/// "AgX (P3-D65)", "AgX (Rec.2020, 1000 nit)".
[[nodiscard]] std::vector<DisplayedView> displayed_views(
    const ConfigModel::View& view, const std::vector<const Display*>& displays);

/// How far code values that a view makes are from themselves after the inverse to the scene and
/// the view again.
struct RoundTripError {
    /// Without loss, and as applications have it: with OpenColorIO's default optimization.
    ErrorStats lossless;
    ErrorStats by_default;
    bool is_measured = false;
    /// False where what comes back is another picture.
    bool exists = false;
};

/// How far a view is from the reference, and its inverse from itself.
struct ViewError {
    ErrorStats in_gamut;
    double delta_e = 0;
    bool is_exact = true;
    RoundTripError back;
};

/// Makes the parts of a config from the model and adds them to an OCIO one: to a new one, or to
/// somebody's.
class ConfigBuilder {
  public:
    ConfigBuilder(const ConfigModel& model, OCIO::ConfigRcPtr config, LutFiles luts);

    /// The config is somebody's, with references of its own.
    /// @param scene, display  what its interchange spaces are of its references
    void set_references(OCIO::ConstColorSpaceRcPtr scene, OCIO::ConstColorSpaceRcPtr display) {
        scene_ = std::move(scene);
        display_ = std::move(display);
    }

    void add_spaces();
    void add_untonemapped();
    void add_view_transforms();
    void add_looks();

    /// The views of a new config: shared where they are the same on every display.
    void add_views();
    void add_output_spaces();

    /// On somebody's display, which shows what `display` does through its own space.
    void add_views_to(const Display& display, const std::string& host_display,
                      const std::string& host_space);

    void add_file_rules();

    /// The config as YAML, of the profile that it has.
    [[nodiscard]] std::string text() const;
    /// A new config as YAML.
    /// @param profile  2.0, 2.1 or 2.5
    [[nodiscard]] std::string text(const std::string& profile) const;

    [[nodiscard]] std::vector<GeneratedFile> tables() const { return luts_.files(); }
    [[nodiscard]] const std::vector<DisplayedView>& displayed(const std::string& view) const {
        return displayed_.at(view);
    }
    /// Largest code value error of each view on each display.
    using LargestErrors = std::map<std::string, std::map<std::string, double>>;
    [[nodiscard]] const LargestErrors& largest_errors() const { return largest_errors_; }
    /// Of each view, on the first display.
    [[nodiscard]] const std::map<std::string, ViewError>& errors() const { return errors_; }

  private:
    /// Between the references of somebody's config what goes from ACES2065-1 to CIE XYZ D65, or,
    /// inverse, the other way.
    [[nodiscard]] OCIO::GroupTransformRcPtr between_references(
        const OCIO::GroupTransformRcPtr& group, OCIO::TransformDirection direction) const;

    static void append_conversion(OCIO::GroupTransformRcPtr& group, const OCIO::ColorSpace& space,
                                  OCIO::ColorSpaceDirection direction);

    void add_virtual_display();

    void add_shared_view(const std::string& name, const std::string& transform,
                         const std::string& space, const std::string& description);

    /// Of OpenColorIO 2.4 and newer: its built-in transform where ours is a cube.
    void use_builtins(const OCIO::ConfigRcPtr& config) const;

    /// What takes time of a view transform, on any thread.
    struct LoweredView;
    [[nodiscard]] LoweredView lower_view(const ConfigModel::View& view, const DisplayedView& shown,
                                         bool is_first) const;
    void add_view_transform(const ConfigModel::View& view, const DisplayedView& shown,
                            const LoweredView& lowered);

    const ConfigModel& model_;
    OCIO::ConfigRcPtr config_;
    OCIO::ConstColorSpaceRcPtr scene_, display_;  // null: ours
    LutFiles luts_;
    std::map<std::string, std::vector<DisplayedView>> displayed_;
    LargestErrors largest_errors_;
    std::map<std::string, ViewError> errors_;
    /// View transforms that are cubes.
    std::set<std::string> cubes_;
    /// Of each view transform, what its inverse is.
    std::map<std::string, std::string> inverses_;
    /// Colors that errors are measured on; none has a negative channel.
    SampleSet samples_, wide_samples_, few_samples_;
};

TONEWRIGHT_NAMESPACE_END
