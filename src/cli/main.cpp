// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <typeinfo>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/command.h"
#include "cli/completion.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "tasks/engines.h"
#include "tonewright/definition.h"
#include "tonewright/engines.h"
#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::terminate_handler default_handler = nullptr;
std::atomic<bool> has_failed_to_allocate = false;
int messages = -1;  // stderr, which is off while OpenImageIO writes to it

/// If a function that must not throw is inlined, GCC 12 ends the process without passing the
/// exception to the handler.
bool is_about_memory_now() {
    try {
        if (const std::exception_ptr exception = std::current_exception())
            std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
        return true;
    } catch (...) {
        return false;
    }
    return has_failed_to_allocate;
}

/// If memory runs out in a function that must not throw, or while another exception is handled, the
/// process ends as for any other lack of memory. Nothing here allocates.
[[noreturn]] void end_without_memory() {
    if (is_about_memory_now() || is_loading_under_limit()) {
        // Prints one line, also if several threads come here.
        static std::atomic_flag is_ending = ATOMIC_FLAG_INIT;
        while (is_ending.test_and_set())
            ::pause();
        remove_unfinished_files();
        constexpr std::string_view kMessage = "tonewright: not enough memory\n";
        [[maybe_unused]] const ssize_t size = ::write(messages, kMessage.data(), kMessage.size());
        ::_exit(kFile);
    }
    default_handler();
    std::abort();
}

/// Before the program's own static objects, because those of CLI11 allocate.
[[gnu::constructor(101)]] void handle_missing_memory() {
    messages = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    default_handler = std::set_terminate(end_without_memory);
    std::set_new_handler([] {
        has_failed_to_allocate = true;
        throw std::bad_alloc();
    });
}

bool is_out_of_memory = false;

int report(const std::string& message, int exit_code) {
    print_message(message);
    return exit_code;
}

int report_memory(const std::string& message) {
    is_out_of_memory = true;
    return report(message, kFile);
}

int report(const Problem& problem) {
    is_out_of_memory = problem.kind == Problem::Kind::memory;
    print_message(command_text(problem));
    switch (problem.kind) {
        case Problem::Kind::usage:
            return kUsage;
        case Problem::Kind::check:
            return kCheckFailed;
        default:
            return kFile;
    }
}

/// These variables let OpenColorIO measure with other optimizations, and hide displays, views and
/// spaces. They override what a caller asks for, and OpenColorIO has no other way around them.
/// Files and measurements must not depend on them. A library must not change the environment of
/// its application, but a program may, before it has threads.
void ignore_overrides_of_opencolorio() {
    for (const char* name : {"OCIO_OPTIMIZATION_FLAGS", "OCIO_ACTIVE_DISPLAYS", "OCIO_ACTIVE_VIEWS",
                             "OCIO_INACTIVE_COLORSPACES"})
        ::unsetenv(name);
}

int run(int argc, char** argv) {
    const std::string command = argc > 1 ? one_line(argv[1]) + ": " : "";
    lut_picture_reader() = [](const std::string& path) {
        return picture_commands().read_lut(path);
    };
    try {
        const std::unique_ptr<CommandLine> program = make_command_line();
        int exit_code = kOk;
        if (argc > 1 && std::string_view(argv[1]) == "complete") {  // for the scripts of shells
            const std::string text = to_text(complete(program->tables(), {argv + 2, argv + argc}));
            std::fputs(text.c_str(), stdout);
        } else {
            exit_code = program->run(argc, argv);
        }
        if (std::fflush(stdout) != 0) return report("write: standard output: cannot write", kFile);
        return exit_code;
    } catch (const std::filesystem::filesystem_error& e) {
        return report(command + e.path1().string() + ": " + e.code().message(), kFile);
    } catch (const std::system_error& e) {  // exceptions of printing, and a thread without a stack
        if (e.code() == std::errc::resource_unavailable_try_again)
            return report_memory(command + "not enough memory or threads");
        return report("write: standard output: " + e.code().message(), kFile);
    } catch (const std::bad_alloc&) {
        return report_memory(command + "not enough memory");
    } catch (const DefinitionError& e) {
        const int exit_code = report(e.problem());
        print_excerpt(e.excerpt());
        return exit_code;
    } catch (const AmbiguousNameError& e) {
        const int exit_code = report(e.problem());
        print_excerpt(to_text(meaning_table(e.name())));
        return exit_code;
    } catch (const Error& e) {
        return report(e.problem());
    } catch (const std::exception& e) {  // of another library
        return report(command + one_line(e.what()), kFile);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END

int main(int argc, char** argv) {
    tonewright::ignore_overrides_of_opencolorio();
    tonewright::remove_unfinished_files_on_signals();
    const int exit_code = tonewright::run(argc, argv);
    // OpenImageIO 2.4 hangs in a destructor after an exception passed a lock of its cache.
    if (tonewright::is_out_of_memory) ::_exit(exit_code);
    return exit_code;
}
