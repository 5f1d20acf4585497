#include "proposal/proposal.h"
