#include "meshing/tet_mesh.h"
