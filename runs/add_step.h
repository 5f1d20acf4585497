// The next step of a run by adding an effect or taking one back; `hookeye add` and the studio.
#pragma once

#include <functional>
#include <string>

#include "runs/record.h"

namespace hookeye {

struct AddRequest {
  std::string effect;
  bool take_back = false;
  std::string form = {};  ///< name of its form (form_name); empty: as the refit finds it
};

struct AddOptions {
  FitOptions fit;
  DiagnosisOptions diagnosis;
  std::function<void(const std::string& work)> doing;     ///< told what begins; may be empty
  std::function<void(const std::string& sentence)> note;  ///< may be empty
};

/// Throws InputError for an effect that is unknown, cannot be added or is not in the model; Failed
/// or Interrupted where there is no result. `current` must be the newest step; where its diagnosis
/// does not hold the effect, it is diagnosed first.
Step next_step(Bench& bench, const Step& current, const AddRequest& request,
               const AddOptions& options);

/// Throws InputError with the nearest name.
void check_effect(const std::string& name);

/// Throws InputError where an effect is to be taken back that the newest step does not have, or to
/// be added that it has.
void check_stands(const Run& run, const AddRequest& request);

/// Throws InputError with those that there are where the effect has no such form in this model.
void check_form(const Fitted& current, const AddRequest& request);

/// "form:      ball ('free ball'); `--as` takes blob, ...", or empty where the effect has one form.
std::string form_taken(const Fitted& fitted, const std::string& effect);

}  // namespace hookeye
