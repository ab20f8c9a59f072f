// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "base/atomic_file.h"
#include "cli/pictures/commands.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class Commands : public PictureCommands {
  public:
    // In a static build the module has a list of unfinished files of its own.
    Commands() {
        remove_unfinished_files_on_signals();
        lut_picture_reader() = load_lut_picture;
    }
    void use_messages(const MessageOptions& options) const override { message_options() = options; }
    [[nodiscard]] int apply(const ApplyOptions& options) const override {
        return run_apply(options);
    }
    [[nodiscard]] int meter(const MeterCommandOptions& options) const override {
        return run_meter(options);
    }
    void compare(const CompareOptions& options) const override { run_compare(options); }
    void chart(const ChartOptions& options) const override { run_chart(options); }
    void sheet(const SheetOptions& options) const override { run_sheet(options); }
    void info(const InfoOptions& options) const override { run_info(options); }
    [[nodiscard]] std::vector<float> read_pixels(const std::string& path) const override {
        return read_picture_pixels(path);
    }
    void write_plot(const CurvePlot& plot, const std::string& path, int width) const override {
        write_plot_file(plot, path, width);
    }
    [[nodiscard]] Lut read_lut(const std::string& path) const override {
        return load_lut_picture(path);
    }
    void write_lut(const Lut& lut, LutFormat format, const std::string& path,
                   int bits) const override {
        write_lut_picture(lut, format, path, bits);
    }
    void write_shipped_luts(const std::string& folder,
                            const std::string& application) const override {
        tonewright::write_shipped_luts(folder, application);
    }
    [[nodiscard]] ReportPicture read_report_picture(
        const ReportPictureOptions& options) const override {
        return tonewright::read_report_picture(options);
    }
};

}  // namespace

extern "C" [[gnu::visibility("default")]] const PictureCommands* tonewright_picture_commands(
    const char* build) {
    if (std::string_view(build) != kPictureCommandsBuild) return nullptr;
    static const Commands commands;
    return &commands;
}

TONEWRIGHT_NAMESPACE_END
