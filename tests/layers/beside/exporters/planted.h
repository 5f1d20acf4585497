#pragma once

#include "estimation/fit/fit.h"
#include "importers/importer.h"
