// Nothing: a target needs a source file to have a precompiled header.
