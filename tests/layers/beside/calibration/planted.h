#include "importers/importer.h"
