// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: LUT files of any bytes, as OpenColorIO and Little CMS run them, and as operators. The
// first byte chooses the format. OpenColorIO itself is not instrumented.
#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "fuzz/private_folder.h"
#include "lut/lut_text.h"
#include "tonewright/lut_file.h"

namespace {

using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program

void check_line(const FileError& e) {
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
}

void check_finite(const std::vector<double>& numbers) {
    if (!std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); }))
        std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const PrivateFolder folder;
    static const std::vector<std::string> extensions = [] {
        silence_opencolorio();
        std::vector<std::string> known = lut_text_extensions();
        known.insert(known.end(), {".raw", ".icc", ".dds"});
        return known;
    }();
    if (size == 0) return 0;
    const std::string path = folder.write("x" + extensions[data[0] % extensions.size()],
                                          {reinterpret_cast<const char*>(data) + 1, size - 1});
    try {
        const LutFile lut(path);
        const float in[] = {0.1F, 0.5F, 0.9F, -1, 2, NAN};
        float out[6] = {};
        lut.run_rgb(in, out, 2);
    } catch (const FileError& e) {
        check_line(e);
    }
    // Readers without files of an earlier run in their caches.
    for (const TableReader& reader : {table_reader(), ocio_table_reader(table_reader())}) {
        try {
            for (const Stage& stage : reader(path).stages) {
                const auto* curve = std::get_if<CurveStage>(&stage);
                for (std::size_t c = 0; curve && c < 3; ++c) {
                    const Expr& f = curve->f.at(c);
                    if (f.op() == ExprOp::lookup) check_finite(f.table()->samples);
                }
            }
        } catch (const FileError& e) {
            check_line(e);
        }
    }
    // It keeps every file that it has read.
    static std::size_t count = 0;
    if (++count % 100 == 0) OCIO_NAMESPACE::ClearAllCaches();
    return 0;
}
