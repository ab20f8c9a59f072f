// SPDX-License-Identifier: Apache-2.0
//
// An OpenImageIO plugin that reads files as a bad reader would: one that hangs, crashes or ends the
// process while it reads pixels. The text of a `.hostile` file says which.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

class HostileInput : public OIIO::ImageInput {
  public:
    [[nodiscard]] const char* format_name() const override { return "hostile"; }

    bool open(const std::string& name, OIIO::ImageSpec& spec) override {
        std::ifstream file(name);
        if (!(file >> what_)) {
            errorfmt("{} cannot be read", name);
            return false;
        }
        m_spec = spec = OIIO::ImageSpec(16, 16, 3, OIIO::TypeFloat);
        return true;
    }

    bool close() override { return true; }

    bool read_native_scanline(int /*subimage*/, int /*miplevel*/, int y, int /*z*/,
                              void* data) override {
        if (y == 8 && what_ == "hang") {
            while (true)
                ::pause();
        }
        if (y == 8 && what_ == "crash") (void)::raise(SIGSEGV);
        if (y == 8 && what_ == "exit") ::_exit(0);
        auto* values = static_cast<float*>(data);
        for (int i = 0; i < 3 * m_spec.width; ++i)
            values[i] = static_cast<float>(y + 1) / 16;
        return true;
    }

  private:
    std::string what_;
};

}  // namespace

OIIO_PLUGIN_EXPORTS_BEGIN

OIIO_EXPORT int hostile_imageio_version = OIIO_PLUGIN_VERSION;
OIIO_EXPORT const char* hostile_imageio_library_version() { return nullptr; }
OIIO_EXPORT OIIO::ImageInput* hostile_input_imageio_create() { return new HostileInput; }
OIIO_EXPORT const char* hostile_input_extensions[] = {"hostile", nullptr};

OIIO_PLUGIN_EXPORTS_END
