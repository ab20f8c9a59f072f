// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>
#include <system_error>

#include "base/strings.h"
#include "shader_runs/child_process.h"
#include "shader_runs/run_on_dawn.h"
#include "shader_runs/shader_run.h"
#include "tonewright/error.h"
#include "verify/private_folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

constexpr const char* kWgslMain = R"(
@group(1) @binding(0) var<storage, read> colors: array<f32>;
@group(1) @binding(1) var<storage, read_write> shown: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    let i = 3u * id.x;
    let c = {}(vec3<f32>(colors[i], colors[i + 1u], colors[i + 2u]));
    shown[i] = c.r;
    shown[i + 1u] = c.g;
    shown[i + 2u] = c.b;
}}
)";
constexpr const char* kHlslMain = R"(
[[vk::binding(0, 1)]] StructuredBuffer<float> colors;
[[vk::binding(1, 1)]] RWStructuredBuffer<float> shown;
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {{
    uint i = 3 * id.x;
    float3 c = {}(float3(colors[i], colors[i + 1], colors[i + 2]));
    shown[i] = c.r;
    shown[i + 1] = c.g;
    shown[i + 2] = c.b;
}}
)";

void write_floats(const std::string& path, const float* values, std::size_t count) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(values),
               static_cast<std::streamsize>(count * sizeof(float)));
}

/// Node.js with run_on_dawn.mjs. It takes a line for a step and answers with a line.
class DawnProcess {
  public:
    DawnProcess(const std::string& modules, const PrivateFolder& folder)
        : log_(folder.file("dawn.log")) {
        const std::string program = folder.file("run_on_dawn.mjs");
        std::ofstream(program) << kRunOnDawn;
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
            throw Error("socketpair: " + std::generic_category().message(errno));
        socket_.emplace(ends[0]);
        const OwnedDescriptor theirs(ends[1]);
        const OwnedDescriptor messages(log_);
        process_.emplace(std::vector<std::string>{"node", program, modules}, theirs.get(),
                         theirs.get(), messages.get());
        // A driver that hangs should not hang us.
        const struct timeval longest { 120, 0 };
        ::setsockopt(socket_->get(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
    }

    /// @throws Error  with its message, where it has ended
    std::string answer() {
        std::string line;
        char c = 0;
        while (::recv(socket_->get(), &c, 1, 0) == 1) {
            if (c == '\n') return line;
            line += c;
        }
        throw Error("Dawn: " + first_error(log_));
    }

    std::string ask(const std::string& step) {
        const std::string line = step + "\n";
        // Short: a socket takes it as a whole.
        (void)::send(socket_->get(), line.data(), line.size(), MSG_NOSIGNAL);
        return answer();
    }

  private:
    std::string log_;
    std::optional<OwnedDescriptor> socket_;
    std::optional<ChildProcess> process_;
};

/// WGSL on Dawn, the implementation of WebGPU in Chromium; HLSL by way of SPIR-V and WGSL.
class DawnRun : public ShaderRun {
  public:
    explicit DawnRun(bool is_hlsl) : is_hlsl_(is_hlsl) {
        const char* const modules = std::getenv("TONEWRIGHT_NODE_MODULES");
        if (!modules || !*modules) throw Error("TONEWRIGHT_NODE_MODULES is not set");
        modules_ = fs::absolute(modules).string();
        for (const char* package : {"webgpu", "naga-wasm"}) {
            if ((is_hlsl || package == std::string_view("webgpu")) &&
                !fs::is_directory(fs::path(modules_) / package))
                throw Error(std::string("TONEWRIGHT_NODE_MODULES has no ") + package);
        }
    }

    [[nodiscard]] std::string by() const override { return adapter_; }

    void run_rgb(const Shader& shader, const float* in, float* out,
                 std::size_t pixel_count) override {
        std::string source = is_hlsl_ ? "function.hlsl" : "function.wgsl";
        std::ofstream(folder_.file(source))
            << shader.text
            << fmt::format(fmt::runtime(is_hlsl_ ? kHlslMain : kWgslMain), shader.function);
        if (is_hlsl_) {
            run_program(
                {"glslangValidator", "-D", "-V", "--quiet", "--auto-map-bindings", "-S", "comp",
                 "-e", "main", folder_.file(source), "-o", folder_.file("function.spv")},
                folder_.file("log"));
            source = "function.spv";
        }
        std::string textures;
        for (const ShaderTexture& texture : shader.textures) {
            const std::string file = texture.name + ".rgba32f";
            write_floats(folder_.file(file), texture.rgba.data(), texture.rgba.size());
            textures +=
                fmt::format(R"({}{{"file": {}, "size": [{}]}})", textures.empty() ? "" : ", ",
                            quoted(file), fmt::join(texture.size, ", "));
        }
        write_floats(folder_.file("colors"), in, 3 * pixel_count);
        try {
            if (!process_) {
                process_.emplace(modules_, folder_);
                adapter_ = "Dawn, " + process_->answer();
            }
            process_->ask(
                fmt::format(R"({{"source": {}, "input": {}, "out": {}, "textures": [{}]}})",
                            quoted(source), quoted("colors"), quoted("shown"), textures));
        } catch (const Error&) {
            process_.reset();  // it ends at the first error
            throw;
        }
        std::ifstream(folder_.file("shown"), std::ios::binary)
            .read(reinterpret_cast<char*>(out),
                  static_cast<std::streamsize>(3 * pixel_count * sizeof(float)));
    }

  private:
    /// The path of a file of ours, as a JSON string.
    [[nodiscard]] std::string quoted(const std::string& name) const {
        std::ostringstream text;
        text << std::quoted(folder_.file(name));
        return text.str();
    }

    PrivateFolder folder_;
    std::string modules_;
    std::string adapter_;
    bool is_hlsl_;
    std::optional<DawnProcess> process_;
};

}  // namespace

std::unique_ptr<ShaderRun> run_wgsl_on_dawn() { return std::make_unique<DawnRun>(false); }
std::unique_ptr<ShaderRun> run_hlsl_on_dawn() { return std::make_unique<DawnRun>(true); }

TONEWRIGHT_NAMESPACE_END
