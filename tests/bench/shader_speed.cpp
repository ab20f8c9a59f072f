// SPDX-License-Identifier: Apache-2.0
// Times GLSL functions `vec3 NAME(vec3 scene)` on a GPU (see docs/shaders.md): a 4K picture of half
// floats to another, by a fragment shader and by a compute shader. Beside them, a copy and a 3D LUT
// of 33 nodes a side in half floats, which the texture unit interpolates.
//
// Usage: tonewright_shader_speed FILE.glsl...
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr GLsizei kWidth = 3840;
constexpr GLsizei kHeight = 2160;
constexpr double kMeasured = 2e4;  // microseconds of one measurement, roughly
constexpr int kRepeats = 5;        // the fastest counts
constexpr GLsizei kLutSize = 33;

constexpr const char* kVertexShader = R"(#version 430
void main() {
    gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID & 2) - 1, 0, 1);
}
)";
constexpr const char* kFragmentTail = R"(
layout(binding = 0) uniform sampler2D bench_input;
out vec4 bench_output;
void main() {
    bench_output = vec4(FUNCTION(texelFetch(bench_input, ivec2(gl_FragCoord.xy), 0).rgb), 1.0);
}
)";
constexpr const char* kComputeTail = R"(
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0) uniform sampler2D bench_input;
layout(binding = 0, rgba16f) writeonly uniform image2D bench_output;
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    imageStore(bench_output, at, vec4(FUNCTION(texelFetch(bench_input, at, 0).rgb), 1.0));
}
)";
constexpr const char* kCopy = "vec3 copy(vec3 scene) { return scene; }\n";
constexpr const char* kLut = R"(layout(binding = 1) uniform sampler3D bench_lut;
vec3 lut_33(vec3 scene) {
    vec3 x = clamp((log2(max(scene, vec3(1e-6))) + 12.47393) / 16.5, 0.0, 1.0);
    return textureLod(bench_lut, x * (32.0 / 33.0) + 0.5 / 33.0, 0.0).rgb;
}
)";

void open_context() {
    const auto query = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(  // NOLINT: EGL's own way
        eglGetProcAddress("eglQueryDevicesEXT"));
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (query == nullptr || query(16, devices.data(), &count) == EGL_FALSE) count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
        if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
            continue;
        eglBindAPI(EGL_OPENGL_API);
        const std::array<EGLint, 5> wanted = {EGL_CONTEXT_MAJOR_VERSION, 4,
                                              EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
        EGLContext context =
            eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted.data());
        if (context != EGL_NO_CONTEXT &&
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE)
            return;
    }
    throw std::runtime_error("no EGL device offers OpenGL 4.3");
}

GLuint make_texture(GLenum target) {
    GLuint texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(target, texture);
    for (const GLenum key : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(target, key, target == GL_TEXTURE_3D ? GL_LINEAR : GL_NEAREST);
    for (const GLenum key : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(target, key, GL_CLAMP_TO_EDGE);
    return texture;
}

GLuint link(const std::vector<std::pair<GLenum, std::string>>& shaders) {
    const GLuint program = glCreateProgram();
    std::array<GLchar, 1000> log{};
    GLint ok = GL_FALSE;
    for (const auto& [type, text] : shaders) {
        const GLuint shader = glCreateShader(type);
        const char* source = text.c_str();
        glShaderSource(shader, 1, &source, nullptr);
        glCompileShader(shader);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
        if (ok != GL_TRUE) throw std::runtime_error(log.data());
        glAttachShader(program, shader);
    }
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (ok != GL_TRUE) throw std::runtime_error("the shader does not link");
    glUseProgram(program);
    return program;
}

/// @return  microseconds for a picture
template <class Draw>
double time(const Draw& draw) {
    const auto time_of = [&](int draws) {
        using Clock = std::chrono::steady_clock;
        glFinish();
        const Clock::time_point start = Clock::now();
        for (int i = 0; i < draws; ++i)
            draw();
        glFinish();
        const std::chrono::duration<double, std::micro> taken = Clock::now() - start;
        return taken.count() / draws;
    };
    time_of(1);  // drivers finish compiling at the first draw
    double best = time_of(1);
    const int draws = std::max(1, static_cast<int>(std::min(kMeasured / best, 100.0)));
    for (int repeat = 0; repeat < kRepeats; ++repeat)
        best = std::min(best, time_of(draws));
    if (glGetError() != GL_NO_ERROR) throw std::runtime_error("OpenGL reports an error");
    return best;
}

void measure(const std::string& name, const std::string& text) {
    std::smatch found;
    std::string function;  // the last one
    for (auto at = text.cbegin();
         std::regex_search(at, text.cend(), found, std::regex(R"(vec3 (\w+)\(vec3 scene\))"));
         at = found.suffix().first)
        function = found[1];
    if (function.empty())
        throw std::runtime_error(name + ": has no function `vec3 NAME(vec3 scene)`");
    const auto with_tail = [&](const char* tail) {
        return "#version 430\n" + text +
               std::regex_replace(std::string(tail), std::regex("FUNCTION"), function);
    };
    const GLuint fragment =
        link({{GL_VERTEX_SHADER, kVertexShader}, {GL_FRAGMENT_SHADER, with_tail(kFragmentTail)}});
    const double by_fragment = time([] { glDrawArrays(GL_TRIANGLES, 0, 3); });
    const GLuint compute = link({{GL_COMPUTE_SHADER, with_tail(kComputeTail)}});
    const double by_compute = time([] { glDispatchCompute(kWidth / 16, kHeight / 16, 1); });
    glDeleteProgram(fragment);
    glDeleteProgram(compute);
    std::printf("%s,%.1f,%.1f\n", name.c_str(), by_fragment, by_compute);
    std::fflush(stdout);
}

void run(const std::vector<std::string>& files) {
    open_context();
    std::printf("# %s, %s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                reinterpret_cast<const char*>(glGetString(GL_VERSION)));
    std::printf("# microseconds for a picture of %d x %d pixels\nname,fragment,compute\n", kWidth,
                kHeight);
    std::mt19937 random(1);
    std::vector<float> colors(4UL * kWidth * kHeight);
    for (float& x : colors)
        x = std::exp2(std::uniform_real_distribution<float>(-10, 6)(random));
    std::vector<float> nodes(3UL * kLutSize * kLutSize * kLutSize);
    for (float& x : nodes)
        x = std::uniform_real_distribution<float>(0, 1)(random);

    const GLuint output = make_texture(GL_TEXTURE_2D);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA16F, kWidth, kHeight);
    glBindImageTexture(0, output, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    GLuint framebuffer = 0;
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, output, 0);
    glViewport(0, 0, kWidth, kHeight);
    GLuint vertices = 0;  // the core profile draws nothing without them, even empty ones
    glGenVertexArrays(1, &vertices);
    glBindVertexArray(vertices);
    glActiveTexture(GL_TEXTURE1);
    make_texture(GL_TEXTURE_3D);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA16F, kLutSize, kLutSize, kLutSize, 0, GL_RGB, GL_FLOAT,
                 nodes.data());
    glActiveTexture(GL_TEXTURE0);
    make_texture(GL_TEXTURE_2D);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, kWidth, kHeight, 0, GL_RGBA, GL_FLOAT,
                 colors.data());

    measure("copy", kCopy);
    measure("lut_33", kLut);
    for (const std::string& file : files) {
        std::ifstream in(file);
        if (!in) throw std::runtime_error(file + ": cannot be read");
        measure(file.substr(file.rfind('/') + 1), {std::istreambuf_iterator<char>(in), {}});
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run({argv + 1, argv + argc});
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "shader_speed: %s\n", e.what());
        return 1;
    }
}
