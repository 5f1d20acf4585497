// hookeye.Model: the capture's model as a function of its parameters.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "estimation/model/effect.h"
#include "estimation/model/model.h"
#include "python/capture.h"

namespace hookeye {

/// What a model is at one time: what work is handed, as Python may change the model meanwhile.
struct ModelState {
  std::shared_ptr<OpenedCapture> capture;
  ModelForm form;  ///< without the fixed numbers
  VectorXd p;
  Model realise() const { return form.realise(p); }
};

/// A form of the capture's scene with a value for every parameter; those that are fixed are no
/// parameters of its state(). The interpreter's lock guards it; `working` its workspace.
class PythonModel {
 public:
  /// The base model at its starting values.
  explicit PythonModel(std::shared_ptr<OpenedCapture> capture);
  /// As a run's step has it: numbers that it holds are fixed.
  PythonModel(std::shared_ptr<OpenedCapture> capture, const ModelForm& form, const VectorXd& p);

  const std::shared_ptr<OpenedCapture>& capture() const { return capture_; }
  std::vector<Parameter> parameters() const { return whole_.parameters(); }  ///< fixed ones too
  const VectorXd& values() const { return values_; }                         ///< of those
  bool is_fixed(const std::string& name) const { return fixed_.count(name) > 0; }
  /// Throws InputError for a name that is none and for a value out of its bounds.
  size_t index_of(const std::string& name) const;
  void set(const std::string& name, double value);
  void fix(const std::string& name);
  void free(const std::string& name);
  /// Its form of this variant ("": the first) at the null values. Throws InputError.
  void add(const std::string& effect, const std::string& variant);
  void remove(const std::string& effect);
  std::vector<std::string> variants(const std::string& effect) const;
  std::vector<std::string> ingredients() const;
  /// As model.yaml has it.
  std::string text() const;

  ModelState state() const;

  Workspace& workspace();
  std::mutex working;

 private:
  ModelForm form() const;
  VectorXd p() const;
  Ingredients candidates(const std::string& effect) const;

  std::shared_ptr<OpenedCapture> capture_;
  ModelForm whole_;
  VectorXd values_;
  std::set<std::string> fixed_;
  std::unique_ptr<Workspace> workspace_;
};

void bind_model(pybind11::module_& m);

}  // namespace hookeye
