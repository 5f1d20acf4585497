// docs/missing.md says more; so do planted.md, "Planted", and planted.md, "No such heading".
