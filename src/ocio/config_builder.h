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

/// One view transform for all displays that share it: "AgX", or if there are several, "AgX
/// (P3-D65)", "AgX (Rec.2020, 1000 nit)".
[[nodiscard]] std::vector<DisplayedView> displayed_views(
    const ConfigModel::View& view, const std::vector<const Display*>& displays);

/// Round trip error: difference of a view's code values after the inverse to the scene and the
/// view.
struct RoundTripError {
    /// Lossless, and with OpenColorIO's default optimization, as in applications.
    ErrorStats lossless;
    ErrorStats by_default;
    bool is_measured = false;
    /// False if the round trip gives another picture.
    bool exists = false;
};

/// Error of a view against the reference, and of its round trip.
struct ViewError {
    ErrorStats in_gamut;
    double delta_e = 0;
    bool is_exact = true;
    RoundTripError back;
};

/// Makes the parts of a config from the model and adds them to a new or an existing OCIO config.
class ConfigBuilder {
  public:
    ConfigBuilder(const ConfigModel& model, OCIO::ConfigRcPtr config, LutFiles luts);

    /// Adds to an existing config with its own reference spaces.
    /// @param scene, display  conversions between its interchange spaces and its references
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

    /// Adds the view to a display of an existing config, which is equivalent to `display`.
    void add_views_to(const Display& display, const std::string& host_display,
                      const std::string& host_space);

    void add_file_rules();

    /// The config as YAML, with its own profile.
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
    /// Per view, on the first display.
    [[nodiscard]] const std::map<std::string, ViewError>& errors() const { return errors_; }

  private:
    /// Converts a transform from ACES2065-1 to CIE XYZ D65, or its inverse, to the references of an
    /// existing config.
    [[nodiscard]] OCIO::GroupTransformRcPtr between_references(
        const OCIO::GroupTransformRcPtr& group, OCIO::TransformDirection direction) const;

    static void append_conversion(OCIO::GroupTransformRcPtr& group, const OCIO::ColorSpace& space,
                                  OCIO::ColorSpaceDirection direction);

    void add_virtual_display();

    void add_shared_view(const std::string& name, const std::string& transform,
                         const std::string& space, const std::string& description);

    /// For OpenColorIO 2.4 and newer: its built-in transform, where ours is a 3D LUT.
    void use_builtins(const OCIO::ConfigRcPtr& config) const;

    /// The slow part of a view transform; runs on any thread.
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
    /// View transforms with 3D LUTs.
    std::set<std::string> cubes_;
    /// Description of the inverse of each view transform.
    std::map<std::string, std::string> inverses_;
    /// Colors that errors are measured on; none has a negative channel.
    SampleSet samples_, wide_samples_, few_samples_;
};

TONEWRIGHT_NAMESPACE_END
