// The commands of the program, one file each. A new command: write its file with an AddCommand and
// list it here; main.cpp reads this list.
#pragma once

#include "app/session.h"

namespace hookeye {

void add_check(CLI::App& app, CommandBody& chosen);
void add_mesh(CLI::App& app, CommandBody& chosen);
void add_simulate(CLI::App& app, CommandBody& chosen);
void add_render(CLI::App& app, CommandBody& chosen);
void add_fit(CLI::App& app, CommandBody& chosen);
void add_compare(CLI::App& app, CommandBody& chosen);
void add_diagnose(CLI::App& app, CommandBody& chosen);
void add_add(CLI::App& app, CommandBody& chosen);
void add_discover(CLI::App& app, CommandBody& chosen);
void add_explain(CLI::App& app, CommandBody& chosen);
void add_plan(CLI::App& app, CommandBody& chosen);
void add_synth(CLI::App& app, CommandBody& chosen);
void add_report(CLI::App& app, CommandBody& chosen);
void add_studio(CLI::App& app, CommandBody& chosen);
void add_effects(CLI::App& app, CommandBody& chosen);
void add_import(CLI::App& app, CommandBody& chosen);
void add_new(CLI::App& app, CommandBody& chosen);
void add_calibrate(CLI::App& app, CommandBody& chosen);
void add_export(CLI::App& app, CommandBody& chosen);
void add_profile(CLI::App& app, CommandBody& chosen);
void add_doctor(CLI::App& app, CommandBody& chosen);
void add_manual(CLI::App& app, CommandBody& chosen);
void add_place(CLI::App& app, CommandBody& chosen);
void add_edit(CLI::App& app, CommandBody& chosen);
void add_batch(CLI::App& app, CommandBody& chosen);
void add_worker(CLI::App& app, CommandBody& chosen);

inline constexpr AddCommand kCommands[] = {
    add_check,   add_mesh,     add_simulate, add_render,    add_fit,    add_compare, add_diagnose,
    add_add,     add_discover, add_explain,  add_plan,      add_synth,  add_report,  add_studio,
    add_effects, add_import,   add_new,      add_calibrate, add_export, add_profile, add_doctor,
    add_manual,  add_place,    add_edit,     add_batch,     add_worker};

}  // namespace hookeye
