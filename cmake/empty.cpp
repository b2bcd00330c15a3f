// SPDX-License-Identifier: BSD-3-Clause
// A target that only precompiles headers needs a source file.
int main() {}
