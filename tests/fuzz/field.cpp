#include "capture_io/field_table.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  hookeye::fuzz::on_file("e.csv", data, size, [](const auto& file) {
    hookeye::read_field_table(file, file.string(), {}, hookeye::FieldHolds::strains);
  });
  return hookeye::fuzz::on_file("u.csv", data, size, [](const auto& file) {
    hookeye::read_field_table(file, file.string());
  });
}
