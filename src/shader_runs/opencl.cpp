// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "base/strings.h"
#include "shader_runs/shader_run.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// The words of DCTL in OpenCL C, as Resolve has them on GPUs that it reaches through OpenCL.
constexpr const char* kWords = R"(
#define __DEVICE__ static
#define __CONSTANT__ __constant
#define make_float3(r, g, b) ((float3)((r), (g), (b)))
#define _powf pow
#define _log2f log2
#define _exp2f exp2
#define _fmaxf fmax
#define _fminf fmin
#define _fabs fabs
#define _sqrtf sqrt
#define _sinf sin
#define _cosf cos
#define _atan2f atan2
#define _floor floor
)";
constexpr const char* kResolveFlags = "-cl-mad-enable -cl-fast-relaxed-math";

// The parts of OpenCL 1.1 in use. Their binary interface is the same everywhere, and all objects
// are pointers.
using Handle = void*;
using Int = std::int32_t;
using Uint = std::uint32_t;
using Flags = std::uint64_t;
constexpr Flags kGpuDevice = 4;
constexpr Flags kAnyDevice = 0xFFFFFFFF;
constexpr Flags kReadWrite = 1;
constexpr Uint kDeviceName = 0x102B;
constexpr Uint kBuildLog = 0x1183;

/// A function of the library by name; takes the type of the pointer that it initializes.
struct Function {
    void* library;
    const char* name;

    template <class F>
    operator F() const {  // NOLINT(google-explicit-constructor): that is its whole purpose
        void* const address = ::dlsym(library, name);
        if (!address) throw Error(std::string("OpenCL without ") + name);
        return reinterpret_cast<F>(address);
    }
};

void* load_library() {
    // Stays loaded: drivers have threads.
    void* const library = ::dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) throw Error("no OpenCL");
    return library;
}

struct OpenCl {
    void* library = load_library();
    Int (*get_platforms)(Uint, Handle*, Uint*) = Function{library, "clGetPlatformIDs"};
    Int (*get_devices)(Handle, Flags, Uint, Handle*, Uint*) = Function{library, "clGetDeviceIDs"};
    Int (*get_device_info)(Handle, Uint, std::size_t, void*, std::size_t*) = Function{
        library, "clGetDeviceInfo"};
    Handle (*create_context)(const std::intptr_t*, Uint, const Handle*, Handle, Handle,
                             Int*) = Function{library, "clCreateContext"};
    Handle (*create_queue)(Handle, Handle, Flags, Int*) = Function{library, "clCreateCommandQueue"};
    Handle (*create_program)(Handle, Uint, const char**, const std::size_t*, Int*) = Function{
        library, "clCreateProgramWithSource"};
    Int (*build_program)(Handle, Uint, const Handle*, const char*, Handle, Handle) = Function{
        library, "clBuildProgram"};
    Int (*get_build_info)(Handle, Handle, Uint, std::size_t, void*, std::size_t*) = Function{
        library, "clGetProgramBuildInfo"};
    Handle (*create_kernel)(Handle, const char*, Int*) = Function{library, "clCreateKernel"};
    Int (*set_argument)(Handle, Uint, std::size_t, const void*) = Function{library,
                                                                           "clSetKernelArg"};
    Handle (*create_buffer)(Handle, Flags, std::size_t, void*, Int*) = Function{library,
                                                                                "clCreateBuffer"};
    Int (*write_buffer)(Handle, Handle, Uint, std::size_t, std::size_t, const void*, Uint, Handle,
                        Handle) = Function{library, "clEnqueueWriteBuffer"};
    Int (*read_buffer)(Handle, Handle, Uint, std::size_t, std::size_t, void*, Uint, Handle,
                       Handle) = Function{library, "clEnqueueReadBuffer"};
    Int (*run_kernel)(Handle, Handle, Uint, const std::size_t*, const std::size_t*,
                      const std::size_t*, Uint, Handle,
                      Handle) = Function{library, "clEnqueueNDRangeKernel"};
    Int (*release_context)(Handle) = Function{library, "clReleaseContext"};
    Int (*release_queue)(Handle) = Function{library, "clReleaseCommandQueue"};
    Int (*release_program)(Handle) = Function{library, "clReleaseProgram"};
    Int (*release_kernel)(Handle) = Function{library, "clReleaseKernel"};
    Int (*release_buffer)(Handle) = Function{library, "clReleaseMemObject"};
};

void check(Int status, const char* what) {
    if (status != 0)
        throw Error(std::string("OpenCL: ") + what + " fails with " + std::to_string(status));
}

using Owned = std::unique_ptr<void, Int (*)(Handle)>;

/// DCTL on an OpenCL device, with the flags that Resolve gives to its compiler.
class OpenClRun : public ShaderRun {
  public:
    OpenClRun() {
        std::vector<Handle> platforms(16);
        Uint count = 0;
        if (cl_.get_platforms(static_cast<Uint>(platforms.size()), platforms.data(), &count) != 0)
            count = 0;
        platforms.resize(std::min<std::size_t>(count, platforms.size()));
        for (const Flags kind : {kGpuDevice, kAnyDevice}) {
            for (const Handle platform : platforms) {
                if (!device_ && cl_.get_devices(platform, kind, 1, &device_, nullptr) != 0)
                    device_ = nullptr;
            }
        }
        if (!device_) throw Error("no OpenCL device");
        context_ = own(cl_.release_context, "a context", [&](Int* status) {
            return cl_.create_context(nullptr, 1, &device_, nullptr, nullptr, status);
        });
        queue_ = own(cl_.release_queue, "a queue", [&](Int* status) {
            return cl_.create_queue(context_.get(), device_, 0, status);
        });
    }

    [[nodiscard]] std::string by() const override {
        std::string name(256, '\0');
        std::size_t size = 0;
        check(cl_.get_device_info(device_, kDeviceName, name.size(), name.data(), &size), "a name");
        return std::string(name.c_str()) + " " + kResolveFlags;
    }

    void run_rgb(const Shader& shader, const float* in, float* out,
                 std::size_t pixel_count) override {
        const std::string text =
            kWords + shader.text +
            "__kernel void tonewright_run(__global const float* in, __global float* out) {\n"
            "    size_t i = 3 * get_global_id(0);\n"
            "    float3 c = " +
            shader.function +
            "((float3)(in[i], in[i + 1], in[i + 2]));\n"
            "    out[i] = c.x;\n    out[i + 1] = c.y;\n    out[i + 2] = c.z;\n}\n";
        const Owned program = own(cl_.release_program, "a program", [&](Int* status) {
            const char* source = text.c_str();
            return cl_.create_program(context_.get(), 1, &source, nullptr, status);
        });
        if (cl_.build_program(program.get(), 1, &device_, kResolveFlags, nullptr, nullptr) != 0)
            throw Error("OpenCL: the text does not compile: " + build_log(program.get()));
        const Owned kernel = own(cl_.release_kernel, "a kernel", [&](Int* status) {
            return cl_.create_kernel(program.get(), "tonewright_run", status);
        });
        const std::size_t size = 3 * pixel_count * sizeof(float);
        const auto make_buffer = [&](Int* status) {
            return cl_.create_buffer(context_.get(), kReadWrite, size, nullptr, status);
        };
        const Owned from = own(cl_.release_buffer, "a buffer", make_buffer);
        const Owned to = own(cl_.release_buffer, "a buffer", make_buffer);
        Uint index = 0;
        for (const Owned* buffer : {&from, &to}) {
            const Handle handle = buffer->get();
            check(cl_.set_argument(kernel.get(), index++, sizeof handle, &handle), "an argument");
        }
        constexpr Uint kWait = 1;
        const Handle queue = queue_.get();
        check(cl_.write_buffer(queue, from.get(), kWait, 0, size, in, 0, nullptr, nullptr),
              "write");
        check(cl_.run_kernel(queue, kernel.get(), 1, nullptr, &pixel_count, nullptr, 0, nullptr,
                             nullptr),
              "run");
        check(cl_.read_buffer(queue, to.get(), kWait, 0, size, out, 0, nullptr, nullptr), "read");
    }

  private:
    template <class Make>
    static Owned own(Int (*release)(Handle), const char* what, const Make& make) {
        Int status = 0;
        const Handle handle = make(&status);
        check(status, what);
        return {handle, release};
    }

    [[nodiscard]] std::string build_log(Handle program) const {
        std::string log(4096, '\0');
        if (cl_.get_build_info(program, device_, kBuildLog, log.size(), log.data(), nullptr) != 0)
            return "no log";
        return one_line(log.c_str(), 200);
    }

    OpenCl cl_;
    Handle device_ = nullptr;
    Owned context_{nullptr, nullptr};
    Owned queue_{nullptr, nullptr};
};

}  // namespace

std::unique_ptr<ShaderRun> run_on_opencl() { return std::make_unique<OpenClRun>(); }

TONEWRIGHT_NAMESPACE_END
