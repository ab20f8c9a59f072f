// SPDX-License-Identifier: Apache-2.0
//
// The whole program: every command. front.cpp starts it for those that read or write pictures.
#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/program.h"
#include "image/picture_file.h"

int main(int argc, char** argv) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    remove_unfinished_files_on_signals();
    return run_program(argc, argv,
                       {add_list, add_eval, add_apply, add_meter, add_bake, add_config, add_verify,
                        add_chart, add_sheet, add_compare, add_plot});
}
