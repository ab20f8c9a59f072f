// SPDX-License-Identifier: Apache-2.0
#include "ocio/gpu.h"

#include "base/strings.h"
#include "tonewright/error.h"

#ifdef TONEWRIGHT_HAVE_EGL

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Colors per draw: a texture of kBatchWidth x kBatchHeight texels, 4 MiB each way. Eight times as
/// many are not faster.
constexpr GLsizei kBatchWidth = 1024;
constexpr GLsizei kBatchHeight = 256;
constexpr std::size_t kBatchPixels = std::size_t{kBatchWidth} * kBatchHeight;

/// Differences between desktop OpenGL and OpenGL ES.
struct Api {
    EGLenum api;
    EGLint renderable;
    EGLint major;
    EGLint profile_key, profile;  // EGL_NONE: there are no profiles
    const char* name;
    const char* version_line;
};
constexpr Api kOpenGl = {EGL_OPENGL_API,
                         EGL_OPENGL_BIT,
                         4,
                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                         "OpenGL 4.0",
                         "#version 400 core\n"};
constexpr Api kOpenGlEs = {EGL_OPENGL_ES_API, EGL_OPENGL_ES3_BIT, 3, EGL_NONE, EGL_NONE,
                           "OpenGL ES 3.0",   "#version 300 es\n"};

/// One triangle that covers the viewport.
constexpr const char* kVertexShader = R"(
void main() {
    gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID & 2) - 1, 0, 1);
}
)";

/// After the function: every fragment is the color of the texel at the same position.
constexpr const char* kFragmentTail = R"(
uniform highp sampler2D tonewright_input;
out vec4 tonewright_output;
void main() {
    vec4 color = texelFetch(tonewright_input, ivec2(gl_FragCoord.xy), 0);
    tonewright_output = )";
constexpr const char* kFunctionName = "tonewright_convert";
constexpr const char* kInputName = "tonewright_input";

/// Makes an OpenGL context current on this thread and restores the previous one, because the
/// application may draw, too.
class Current {
  public:
    Current(EGLenum api, EGLDisplay display, EGLContext context)
        : display_(display),
          previous_api_(eglQueryAPI()),
          previous_display_(eglGetCurrentDisplay()),
          previous_context_(eglGetCurrentContext()),
          previous_draw_(eglGetCurrentSurface(EGL_DRAW)),
          previous_read_(eglGetCurrentSurface(EGL_READ)) {
        eglBindAPI(api);  // per thread; EGL begins with OpenGL ES
        ok_ = eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
    }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
    ~Current() {
        if (ok_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglBindAPI(previous_api_);
        if (previous_context_ != EGL_NO_CONTEXT) {
            eglMakeCurrent(previous_display_, previous_draw_, previous_read_, previous_context_);
        }
    }

    [[nodiscard]] bool ok() const noexcept { return ok_; }

  private:
    EGLDisplay display_;
    EGLenum previous_api_;
    EGLDisplay previous_display_;
    EGLContext previous_context_;
    EGLSurface previous_draw_, previous_read_;
    bool ok_ = false;
};

/// Sources of a context, best first: the devices in the vendors' order (Mesa lists its software
/// rasterizer last), Mesa without a device, the default display of the system.
std::vector<EGLDisplay> candidate_displays() {
    std::vector<EGLDisplay> displays;
    const auto query_devices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (query_devices &&
        query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            displays.push_back(eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        }
    }
    displays.push_back(
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return displays;
}

/// A display and a context that needs no surface. Destroying the context frees all of its objects.
/// The display stays initialized: eglTerminate() would end it for all its users in the process, and
/// Mesa leaks its driver's tables when it unloads the driver.
class EglContext {
  public:
    explicit EglContext(const Api& api) : api_(api) {}
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    ~EglContext() { close(); }

    /// @throws Error  when no display has such a context.
    void open() {
        for (EGLDisplay display : candidate_displays()) {
            if (display != EGL_NO_DISPLAY && open(display)) return;
            close();
        }
        throw Error(std::string("no EGL display offers ") + api_.name + " without a window");
    }

    [[nodiscard]] const Api& api() const noexcept { return api_; }
    [[nodiscard]] Current make_current() const { return {api_.api, display_, context_}; }

  private:
    bool open(EGLDisplay display) {
        if (!eglInitialize(display, nullptr, nullptr)) return false;
        display_ = display;

        // clang-format off
        const std::array config_wanted = {EGL_RENDERABLE_TYPE, api_.renderable,
                                          EGL_SURFACE_TYPE, 0,
                                          EGL_NONE};
        const std::array context_wanted = {EGL_CONTEXT_MAJOR_VERSION, api_.major,
                                           EGL_CONTEXT_MINOR_VERSION, 0,
                                           api_.profile_key, api_.profile,
                                           EGL_NONE};
        // clang-format on
        EGLConfig config = EGL_NO_CONFIG_KHR;  // will do when none is offered: there is no surface
        EGLint config_count = 0;
        eglChooseConfig(display, config_wanted.data(), &config, 1, &config_count);
        const EGLenum previous_api = eglQueryAPI();
        // Without OpenGL support, OpenGL ES refuses the attributes.
        eglBindAPI(api_.api);
        context_ = eglCreateContext(display, config, EGL_NO_CONTEXT, context_wanted.data());
        eglBindAPI(previous_api);
        return context_ != EGL_NO_CONTEXT && make_current().ok();
    }

    void close() noexcept {
        if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
        context_ = EGL_NO_CONTEXT;
    }

    const Api& api_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

/// Any OpenGL function by name; takes the type of the pointer that it initializes.
struct Function {
    const char* name;

    template <typename F>
    operator F() const {  // NOLINT(google-explicit-constructor): that is its whole purpose
        const auto address = eglGetProcAddress(name);
        if (!address) throw Error(std::string("the driver has no ") + name);
        return reinterpret_cast<F>(address);
    }
};

/// The OpenGL functions in use: no library exports them on every system, EGL finds them on all.
struct Gl {
    PFNGLACTIVETEXTUREPROC active_texture = Function{"glActiveTexture"};
    PFNGLATTACHSHADERPROC attach_shader = Function{"glAttachShader"};
    PFNGLBINDFRAMEBUFFERPROC bind_framebuffer = Function{"glBindFramebuffer"};
    PFNGLBINDTEXTUREPROC bind_texture = Function{"glBindTexture"};
    PFNGLBINDVERTEXARRAYPROC bind_vertex_array = Function{"glBindVertexArray"};
    PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer_status = Function{"glCheckFramebufferStatus"};
    PFNGLCOMPILESHADERPROC compile_shader = Function{"glCompileShader"};
    PFNGLCREATEPROGRAMPROC create_program = Function{"glCreateProgram"};
    PFNGLCREATESHADERPROC create_shader = Function{"glCreateShader"};
    PFNGLDELETEPROGRAMPROC delete_program = Function{"glDeleteProgram"};
    PFNGLDELETESHADERPROC delete_shader = Function{"glDeleteShader"};
    PFNGLDELETETEXTURESPROC delete_textures = Function{"glDeleteTextures"};
    PFNGLDRAWARRAYSPROC draw_arrays = Function{"glDrawArrays"};
    PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture_2d = Function{"glFramebufferTexture2D"};
    PFNGLGENFRAMEBUFFERSPROC gen_framebuffers = Function{"glGenFramebuffers"};
    PFNGLGENTEXTURESPROC gen_textures = Function{"glGenTextures"};
    PFNGLGENVERTEXARRAYSPROC gen_vertex_arrays = Function{"glGenVertexArrays"};
    PFNGLGETERRORPROC get_error = Function{"glGetError"};
    PFNGLGETPROGRAMINFOLOGPROC get_program_info_log = Function{"glGetProgramInfoLog"};
    PFNGLGETPROGRAMIVPROC get_program_iv = Function{"glGetProgramiv"};
    PFNGLGETSHADERINFOLOGPROC get_shader_info_log = Function{"glGetShaderInfoLog"};
    PFNGLGETSHADERIVPROC get_shader_iv = Function{"glGetShaderiv"};
    PFNGLGETSTRINGPROC get_string = Function{"glGetString"};
    PFNGLGETUNIFORMLOCATIONPROC get_uniform_location = Function{"glGetUniformLocation"};
    PFNGLLINKPROGRAMPROC link_program = Function{"glLinkProgram"};
    PFNGLREADPIXELSPROC read_pixels = Function{"glReadPixels"};
    PFNGLSHADERSOURCEPROC shader_source = Function{"glShaderSource"};
    PFNGLTEXIMAGE1DPROC tex_image_1d = Function{"glTexImage1D"};
    PFNGLTEXIMAGE2DPROC tex_image_2d = Function{"glTexImage2D"};
    PFNGLTEXIMAGE3DPROC tex_image_3d = Function{"glTexImage3D"};
    PFNGLTEXPARAMETERIPROC tex_parameter_i = Function{"glTexParameteri"};
    PFNGLTEXSUBIMAGE2DPROC tex_sub_image_2d = Function{"glTexSubImage2D"};
    PFNGLUNIFORM1IPROC uniform_1i = Function{"glUniform1i"};
    PFNGLUSEPROGRAMPROC use_program = Function{"glUseProgram"};
    PFNGLVIEWPORTPROC viewport = Function{"glViewport"};

    /// One query without a loop, because a lost context may return errors forever.
    void check(const char* what) const {
        if (const GLenum error = get_error(); error != GL_NO_ERROR) {
            throw Error("gpu: " + std::string(what) + " fails with OpenGL error " +
                        std::to_string(error));
        }
    }

    [[nodiscard]] GLuint make_texture(GLenum target, GLint filter) const {
        GLuint texture = 0;
        gen_textures(1, &texture);
        bind_texture(target, texture);
        tex_parameter_i(target, GL_TEXTURE_MIN_FILTER, filter);
        tex_parameter_i(target, GL_TEXTURE_MAG_FILTER, filter);
        tex_parameter_i(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        tex_parameter_i(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        tex_parameter_i(target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
        return texture;
    }
};

/// The context of the process with the shared textures for input and output colors. Texture unit 0
/// stays with the input.
class Device {
  public:
    /// @throws Error  (without "gpu: ") when there is none.
    explicit Device(const Api& api) : egl_(api) {
        egl_.open();
        const Current current = egl_.make_current();
        gl_ = std::make_unique<const Gl>();
        renderer_ = reinterpret_cast<const char*>(gl_->get_string(GL_RENDERER));

        const auto make_batch = [&] {
            const GLuint texture = gl_->make_texture(GL_TEXTURE_2D, GL_NEAREST);
            gl_->tex_image_2d(GL_TEXTURE_2D, 0, GL_RGBA32F, kBatchWidth, kBatchHeight, 0, GL_RGBA,
                              GL_FLOAT, nullptr);
            return texture;
        };
        const GLuint output = make_batch();
        input_ = make_batch();
        GLuint framebuffer = 0;
        gl_->gen_framebuffers(1, &framebuffer);
        gl_->bind_framebuffer(GL_FRAMEBUFFER, framebuffer);
        gl_->framebuffer_texture_2d(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, output, 0);
        if (gl_->check_framebuffer_status(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            throw Error("the driver cannot draw into float texels");
        }
        GLuint vertex_array = 0;  // the core profile draws nothing without one, even an empty one
        gl_->gen_vertex_arrays(1, &vertex_array);
        gl_->bind_vertex_array(vertex_array);
    }

    [[nodiscard]] const std::string& renderer() const noexcept { return renderer_; }
    [[nodiscard]] const char* version_line() const noexcept { return egl_.api().version_line; }

    /// During its lifetime only this thread can use the OpenGL functions.
    class Session {
      public:
        explicit Session(Device& device)
            : gl(*device.gl_), lock_(device.mutex_), current_(device.egl_.make_current()) {}

        [[nodiscard]] bool ok() const noexcept { return current_.ok(); }
        void require() const {
            if (!ok()) throw Error("gpu: the OpenGL context cannot be made current");
        }

        const Gl& gl;

      private:
        std::lock_guard<std::mutex> lock_;
        Current current_;
    };

    /// Draws with the program in use. At most kBatchPixels.
    void draw(const Session& session, const float* in, float* out, std::size_t pixel_count) const {
        const Gl& gl = session.gl;
        const auto full_rows = static_cast<GLsizei>(pixel_count / kBatchWidth);
        const auto rest = static_cast<GLsizei>(pixel_count % kBatchWidth);
        float* const rest_rgba = &rgba_[4 * (pixel_count - static_cast<std::size_t>(rest))];
        // OpenGL ES only transfers RGBA float texels.
        for (std::size_t i = 0; i < pixel_count; ++i)
            std::copy_n(in + 3 * i, 3, &rgba_[4 * i]);

        gl.active_texture(GL_TEXTURE0);
        gl.bind_texture(GL_TEXTURE_2D, input_);
        if (full_rows > 0) {
            gl.tex_sub_image_2d(GL_TEXTURE_2D, 0, 0, 0, kBatchWidth, full_rows, GL_RGBA, GL_FLOAT,
                                rgba_.data());
        }
        if (rest > 0) {
            gl.tex_sub_image_2d(GL_TEXTURE_2D, 0, 0, full_rows, rest, 1, GL_RGBA, GL_FLOAT,
                                rest_rgba);
        }
        gl.viewport(0, 0, full_rows > 0 ? kBatchWidth : rest, full_rows + (rest > 0 ? 1 : 0));
        gl.draw_arrays(GL_TRIANGLES, 0, 3);
        if (full_rows > 0)
            gl.read_pixels(0, 0, kBatchWidth, full_rows, GL_RGBA, GL_FLOAT, rgba_.data());
        if (rest > 0) gl.read_pixels(0, full_rows, rest, 1, GL_RGBA, GL_FLOAT, rest_rgba);
        for (std::size_t i = 0; i < pixel_count; ++i)
            std::copy_n(&rgba_[4 * i], 3, out + 3 * i);
    }

  private:
    EglContext egl_;  // first, so that it goes last and even when the constructor throws
    std::unique_ptr<const Gl> gl_;
    std::mutex mutex_;
    std::string renderer_;
    GLuint input_ = 0;
    mutable std::vector<float> rgba_ = std::vector<float>(4 * kBatchPixels, 1.0F);  // of a session
};

struct Availability {
    std::shared_ptr<Device> device;  // shared with every processor, which may outlive this
    std::string reason;              // when there is none
};

Availability try_device(const Api& api) {
    try {
        return {std::make_shared<Device>(api), ""};
    } catch (const Error& e) {
        return {nullptr, e.what()};
    }
}

const Availability& availability(GlslDialect dialect = GlslDialect::desktop) {
    if (dialect == GlslDialect::es) {
        static const Availability es = try_device(kOpenGlEs);
        return es;
    }
    static const Availability desktop = try_device(kOpenGl);
    return desktop;
}

OCIO::GpuShaderDescRcPtr describe(const OCIO::ConstProcessorRcPtr& processor,
                                  OCIO::OptimizationFlags flags) {
    OCIO::GpuShaderDescRcPtr desc = OCIO::GpuShaderDesc::CreateShaderDesc();
    desc->setLanguage(OCIO::GPU_LANGUAGE_GLSL_4_0);
    desc->setFunctionName(kFunctionName);
    try {
        processor->getOptimizedGPUProcessor(flags)->extractGpuShaderInfo(desc);
    } catch (const OCIO::Exception& e) {
        throw Error(std::string("gpu: OCIO writes no shader: ") + e.what());
    }
    if (desc->getNumUniforms() != 0) {
        throw Error("gpu: the processor has dynamic properties; expected none");
    }
    return desc;
}

/// The first line of a compiler's or linker's log.
template <typename GetLog>
std::string first_line(const GetLog& get_log, GLuint object) {
    std::array<GLchar, 1024> log{};
    get_log(object, static_cast<GLsizei>(log.size()), nullptr, log.data());
    const std::string text = log.data();
    return text.substr(0, text.find('\n'));
}

}  // namespace

struct GpuProgram {
    struct LutTexture {
        GLenum target;
        GLuint texture;
    };

    std::shared_ptr<Device> device;
    GLuint program = 0;
    std::vector<LutTexture> luts;  // texture unit = index + 1

    GpuProgram() = default;
    GpuProgram(const GpuProgram&) = delete;
    GpuProgram& operator=(const GpuProgram&) = delete;
    ~GpuProgram() {
        if (!device) return;
        const Device::Session session(*device);
        if (!session.ok()) return;  // the context is gone, and with it all that was in it
        for (const LutTexture& lut : luts)
            session.gl.delete_textures(1, &lut.texture);
        session.gl.delete_program(program);
    }

    Device::Session open(GlslDialect dialect) {
        device = availability(dialect).device;
        if (!device) throw Error("gpu: " + availability(dialect).reason);
        return Device::Session(*device);
    }

    // Separate from the constructor, so that the destructor frees the objects of a failed build.
    void build(const OCIO::ConstProcessorRcPtr& processor, OCIO::OptimizationFlags flags) {
        const Device::Session session = open(GlslDialect::desktop);
        session.require();
        // Inside the lock, because OCIO reads its environment variables into one static string.
        const OCIO::GpuShaderDescRcPtr desc = describe(processor, flags);
        const Gl& gl = session.gl;
        link(gl, desc->getShaderText(), std::string(kFunctionName) + "(vec4(color.rgb, 1))");
        upload_1d(gl, *desc);
        upload_3d(gl, *desc);
        gl.check("uploading the LUTs");
    }

    void build(const std::string& text, const std::string& function,
               const std::vector<GlslTexture>& textures, GlslDialect dialect) {
        const Device::Session session = open(dialect);
        session.require();
        const Gl& gl = session.gl;
        link(gl, text, "vec4(" + function + "(color.rgb), 1)");
        for (const GlslTexture& texture : textures) {
            add_texture(gl, GL_TEXTURE_3D, texture.sampler.c_str(), OCIO::INTERP_NEAREST);
            gl.tex_image_3d(GL_TEXTURE_3D, 0, GL_RGBA32F, texture.size[0], texture.size[1],
                            texture.size[2], 0, GL_RGBA, GL_FLOAT, texture.rgba);
        }
        gl.check("uploading the textures");
    }

    /// Builds and uses a program with the functions of `text` that turns a texel into `result`.
    void link(const Gl& gl, const std::string& text, const std::string& result) {
        const std::string vertex_shader = std::string(device->version_line()) + kVertexShader;
        const std::string fragment_shader =
            device->version_line() + text + kFragmentTail + result + ";\n}\n";
        program = gl.create_program();
        const auto attach = [&](GLenum type, const char* source) {
            const GLuint shader = gl.create_shader(type);
            gl.shader_source(shader, 1, &source, nullptr);
            gl.compile_shader(shader);
            gl.attach_shader(program, shader);
            gl.delete_shader(shader);  // when the program goes
            GLint ok = GL_FALSE;
            gl.get_shader_iv(shader, GL_COMPILE_STATUS, &ok);
            if (ok != GL_TRUE) {
                throw Error("gpu: the shader does not compile: " +
                            first_line(gl.get_shader_info_log, shader));
            }
        };
        attach(GL_VERTEX_SHADER, vertex_shader.c_str());
        attach(GL_FRAGMENT_SHADER, fragment_shader.c_str());
        gl.link_program(program);
        GLint ok = GL_FALSE;
        gl.get_program_iv(program, GL_LINK_STATUS, &ok);
        if (ok != GL_TRUE) {
            throw Error("gpu: the shader does not link: " +
                        first_line(gl.get_program_info_log, program));
        }
        gl.use_program(program);
        gl.uniform_1i(gl.get_uniform_location(program, kInputName), 0);
    }

    /// Binds a new texture to the next unit and that unit to the sampler.
    void add_texture(const Gl& gl, GLenum target, const char* sampler, OCIO::Interpolation how) {
        const auto unit = static_cast<GLint>(luts.size() + 1);
        // OCIO's tetrahedral shader fetches and weights nodes itself; filtering would only add the
        // rounding of its coordinates to the values.
        const bool is_filtered = how != OCIO::INTERP_NEAREST && how != OCIO::INTERP_TETRAHEDRAL;
        gl.active_texture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        luts.push_back({target, gl.make_texture(target, is_filtered ? GL_LINEAR : GL_NEAREST)});
        gl.uniform_1i(gl.get_uniform_location(program, sampler), unit);
    }

    void upload_1d(const Gl& gl, const OCIO::GpuShaderDesc& desc) {
        for (unsigned i = 0; i < desc.getNumTextures(); ++i) {
            const char* name = nullptr;
            const char* sampler = nullptr;
            unsigned width = 0;
            unsigned height = 0;
            OCIO::GpuShaderDesc::TextureType channels = OCIO::GpuShaderDesc::TEXTURE_RGB_CHANNEL;
            OCIO::Interpolation how = OCIO::INTERP_LINEAR;
            const float* values = nullptr;
#if OCIO_VERSION_HEX >= 0x02030000  // one argument more: what the height says as well
            auto dimensions = OCIO::GpuShaderDesc::TEXTURE_1D;
            desc.getTexture(i, name, sampler, width, height, channels, dimensions, how);
#else
            desc.getTexture(i, name, sampler, width, height, channels, how);
#endif
            desc.getTextureValues(i, values);

            const bool is_red = channels == OCIO::GpuShaderDesc::TEXTURE_RED_CHANNEL;
            const GLint stored = is_red ? GL_R32F : GL_RGB32F;
            const GLenum given = is_red ? GL_RED : GL_RGB;
            const auto w = static_cast<GLsizei>(width);
            const auto h = static_cast<GLsizei>(height);
            // Half-domain LUTs and those longer than a texture is wide are folded into rows.
            add_texture(gl, h > 1 ? GL_TEXTURE_2D : GL_TEXTURE_1D, sampler, how);
            if (h > 1) {
                gl.tex_image_2d(GL_TEXTURE_2D, 0, stored, w, h, 0, given, GL_FLOAT, values);
            } else {
                gl.tex_image_1d(GL_TEXTURE_1D, 0, stored, w, 0, given, GL_FLOAT, values);
            }
        }
    }

    void upload_3d(const Gl& gl, const OCIO::GpuShaderDesc& desc) {
        for (unsigned i = 0; i < desc.getNum3DTextures(); ++i) {
            const char* name = nullptr;
            const char* sampler = nullptr;
            unsigned edge = 0;
            OCIO::Interpolation how = OCIO::INTERP_LINEAR;
            const float* values = nullptr;
            desc.get3DTexture(i, name, sampler, edge, how);
            desc.get3DTextureValues(i, values);

            const auto n = static_cast<GLsizei>(edge);
            add_texture(gl, GL_TEXTURE_3D, sampler, how);
            gl.tex_image_3d(GL_TEXTURE_3D, 0, GL_RGB32F, n, n, n, 0, GL_RGB, GL_FLOAT, values);
        }
    }

    void run_rgb(const float* in, float* out, std::size_t pixel_count) const {
        const Device::Session session(*device);
        session.require();
        const Gl& gl = session.gl;
        gl.use_program(program);
        for (std::size_t i = 0; i < luts.size(); ++i) {
            gl.active_texture(GL_TEXTURE1 + static_cast<GLenum>(i));
            gl.bind_texture(luts[i].target, luts[i].texture);
        }
        for (std::size_t done = 0; done < pixel_count; done += kBatchPixels) {
            const std::size_t count = std::min(kBatchPixels, pixel_count - done);
            device->draw(session, in + 3 * done, out + 3 * done, count);
        }
        gl.check("drawing");
    }
};

std::string OcioGpu::unavailable_reason() { return availability().reason; }

std::string GlslGpu::renderer(GlslDialect dialect) {
    const auto& device = availability(dialect).device;
    return device ? device->renderer() : "";
}

TONEWRIGHT_NAMESPACE_END

#else  // without EGL

TONEWRIGHT_NAMESPACE_BEGIN

struct GpuProgram {
    template <class... Arguments>
    [[noreturn]] static void build(const Arguments&...) {
        throw Error("gpu: " + OcioGpu::unavailable_reason());
    }
    static void run_rgb(const float*, float*, std::size_t) {}
};

std::string OcioGpu::unavailable_reason() { return "built without EGL"; }

std::string GlslGpu::renderer(GlslDialect) { return ""; }

TONEWRIGHT_NAMESPACE_END

#endif

TONEWRIGHT_NAMESPACE_BEGIN

OcioGpu::OcioGpu(const OCIO::ConstProcessorRcPtr& processor, OCIO::OptimizationFlags flags)
    : program_(std::make_unique<GpuProgram>()) {
    program_->build(processor, flags);
}
OcioGpu::OcioGpu(OcioGpu&&) noexcept = default;
OcioGpu& OcioGpu::operator=(OcioGpu&&) noexcept = default;
OcioGpu::~OcioGpu() = default;

void OcioGpu::run_rgb(const float* in, float* out, std::size_t pixel_count) const {
    program_->run_rgb(in, out, pixel_count);
}

std::string OcioGpu::renderer() { return GlslGpu::renderer(GlslDialect::desktop); }

GlslGpu::GlslGpu(const std::string& text, const std::string& function,
                 const std::vector<GlslTexture>& textures, GlslDialect dialect)
    : program_(std::make_unique<GpuProgram>()) {
    program_->build(text, function, textures, dialect);
}
GlslGpu::GlslGpu(GlslGpu&&) noexcept = default;
GlslGpu& GlslGpu::operator=(GlslGpu&&) noexcept = default;
GlslGpu::~GlslGpu() = default;

void GlslGpu::run_rgb(const float* in, float* out, std::size_t pixel_count) const {
    program_->run_rgb(in, out, pixel_count);
}

TONEWRIGHT_NAMESPACE_END
