// The keys of a field of strains. For capture_fields.cpp alone.
#pragma once

#include <memory>
#include <string>

#include "capture_io/field_table.h"
#include "capture_io/strain_field.h"
#include "capture_io/yaml_section.h"

namespace hookeye {

/// What the table's strains are multiplied by to be fractions.
double strain_scale(const YamlSection& section, const FieldTable& table, const std::string& told);

/// `told`: the file's name; `length` of one of its units; `axes` of its frame.
std::shared_ptr<const StrainSpec> read_strain(const YamlSection& section, const FieldTable& table,
                                              const std::string& told, double length,
                                              const Eigen::Matrix3d& axes);

}  // namespace hookeye
