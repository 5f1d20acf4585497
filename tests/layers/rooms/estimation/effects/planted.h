#include "estimation/evaluation/evaluation.h"
