// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "shader_runs/child_process.h"
#include "shader_runs/shader_run.h"
#include "tonewright/error.h"
#include "verify/private_folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<std::string> words_of(const char* text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;)
        words.push_back(word);
    return words;
}

/// The user's C compiler makes a shared object of each function, which is loaded.
class CompilerRun : public ShaderRun {
  public:
    CompilerRun() {
        const char* const chosen = std::getenv("CC");
        std::vector<std::vector<std::string>> candidates = {{"cc"}, {"gcc"}, {"clang"}};
        if (chosen && !words_of(chosen).empty()) candidates = {words_of(chosen)};
        for (const std::vector<std::string>& candidate : candidates) {
            try {
                compiler_ = candidate;
                compile("int tonewright_nothing;\n");
                return;
            } catch (const Error&) {  // the next one
            }
        }
        throw Error("no C compiler");
    }

    [[nodiscard]] std::string by() const override { return compiler_[0] + " -O2"; }

    void run_rgb(const Shader& shader, const float* in, float* out,
                 std::size_t pixel_count) override {
        const std::string object =
            compile(shader.text +
                    "void tonewright_run(const float* in, float* out, unsigned long n) {\n"
                    "    for (; n > 0; --n, in += 3, out += 3) " +
                    shader.function + "(in, out);\n}\n");
        const std::unique_ptr<void, int (*)(void*)> loaded(
            ::dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL), ::dlclose);
        using Run = void (*)(const float*, float*, unsigned long);
        const auto run =
            loaded ? reinterpret_cast<Run>(::dlsym(loaded.get(), "tonewright_run")) : nullptr;
        if (!run) throw Error(compiler_[0] + ": what it compiles cannot be loaded");
        run(in, out, pixel_count);
    }

  private:
    /// The path of a shared object. Each has another name: the loader would take one that it has
    /// for the same.
    std::string compile(const std::string& text) {
        const std::string source = folder_.file("function.c");
        std::string object = folder_.file(std::to_string(++count_) + ".so");
        std::ofstream(source) << text;
        std::vector<std::string> command = compiler_;
        for (const char* word :
             {"-std=c99", "-O2", "-shared", "-fPIC", source.c_str(), "-o", object.c_str(), "-lm"})
            command.emplace_back(word);
        run_program(command, folder_.file("log"));
        return object;
    }

    PrivateFolder folder_;
    std::vector<std::string> compiler_;
    int count_ = 0;
};

}  // namespace

std::unique_ptr<ShaderRun> run_by_c_compiler() { return std::make_unique<CompilerRun>(); }

TONEWRIGHT_NAMESPACE_END
