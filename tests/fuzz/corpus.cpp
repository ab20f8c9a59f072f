// SPDX-License-Identifier: Apache-2.0
//
// Feeds the files of corpus/TARGET/ to the fuzz targets, without libFuzzer. A target that finds an
// error aborts; the file is the last one printed.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using Target = int(const std::uint8_t*, std::size_t);
// FUZZ_TARGETS is X(dds) X(definition) ...
#define X(name) extern "C" Target fuzz_##name;
FUZZ_TARGETS
#undef X

namespace {

/// @returns  whether the folder has files
bool feed(const std::filesystem::path& folder, Target* target) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::printf("%s\n", entry.path().c_str());
        std::fflush(stdout);
        std::ifstream file(entry.path(), std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        ++count;
    }
    return count > 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path corpus = argv[1];
    bool has_all = true;
#define X(name) has_all = feed(corpus / #name, fuzz_##name) && has_all;
    FUZZ_TARGETS
#undef X
    return has_all ? 0 : 1;
}
