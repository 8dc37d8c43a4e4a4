#!/bin/sh
# The cargo that maturin calls (by the variable CARGO): it builds the extension module among the whole workspace, as the
# tests are built. By itself it would have other features in the crates that all share, and these would be built twice.
# PyO3's own crates would be built twice too, because of maturin's variables. A wheel for all Pythons asks for no interpreter,
# and .cargo/config.toml says that an extension module is built.
unset PYO3_CONFIG_FILE PYO3_BUILD_EXTENSION_MODULE PYO3_PYTHON PYO3_ENVIRONMENT_SIGNATURE
case "$1" in
rustc) exec "$BREAKAWAY_CARGO" build --workspace --all-features --lib --tests --message-format json-render-diagnostics ;;
*) exec "$BREAKAWAY_CARGO" "$@" ;;
esac
