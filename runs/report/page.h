// The built page (studio/dist/page.html, inside the program) with a document put into it.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "runs/report/run_view.h"

namespace hookeye {

/// Whether the program was built with it.
bool has_page();

/// Throws InputError when the program was built without Node.js, hence without its page.
/// `parts`: elements made by part(), put after the page's script so that they do not delay it.
std::string make_page(const nlohmann::json& document, const std::string& parts = {});

/// What cannot be put into a page: "NAME is damaged (...): ..."
struct DamagedPart : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A blob as an element of the page, found there by its name. Throws DamagedPart.
std::string part(const std::string& name, const RunView::Blob& blob);

/// Names of all blobs that a document refers to, each once.
std::vector<std::string> blob_names(const nlohmann::json& document);

}  // namespace hookeye
