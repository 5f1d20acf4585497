// Input decks by keywords, as Abaqus and CalculiX read them. For this folder alone.
#pragma once

#include "exporters/exporter.h"

namespace hookeye::deck {

/// What the two programs do differently.
struct Dialect {
  std::string program;      ///< "CalculiX"
  std::string printed;      ///< variables of *NODE PRINT
  std::string results;      ///< further cards of output, in the step
  size_t most_ogden_terms;  ///< of *HYPERELASTIC, OGDEN
  const char* swelling;     ///< what it makes of a thermal strain
  bool elastic_by_green;    ///< *ELASTIC is linear between stress and Green strain
  double pressed_step;      ///< largest increment of a step where a pressure follows faces
};

/// Node k of an element in the order of these programs is node kOrder[k] of TetMesh: they count the
/// mid-edge nodes 12 23 31 14 24 34.
inline constexpr int kOrder[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
/// Corners of face 1 to 4 of an element.
inline constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

/// mesh.inp, and CASE.inp a load case.
Exported write(const SolverModel& model, const Dialect& dialect);

/// Of names in the capture, each: capitals, digits and _, first a letter; told apart by a number.
std::vector<std::string> set_names(const SolverModel& model);
/// A number in no more than 20 characters.
std::string number(double value);
/// Face (1 to 4) of its element, of a column of the mesh's boundary.
int face_number(const TetMesh& mesh, int face);

/// *MATERIAL with its energy.
std::string material_cards(const SolverModel& model, const SolverMaterial& material, double factor,
                           const Dialect& dialect);
/// What the cards of all materials do not hold, in sentences.
std::vector<std::string> material_lacks(const SolverModel& model, const Dialect& dialect);
/// A second set of elements at the same nodes holds the linear part of such a material.
bool has_both(const SolverMaterial& material);

/// Springs of a load case: a share of each face's bed at each of its nodes.
std::string spring_cards(const SolverModel& model, const SolverCase& one, int first_element);

}  // namespace hookeye::deck
