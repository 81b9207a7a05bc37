# Short names for the common commands; `just --list` shows them. Each only calls a script or cargo.

# Everything a change must pass, as CI runs it
check:
    .ci/run

# All tests; arguments go to `cargo test`
test *args:
    scripts/test {{args}}

# Render one scene: just render examples/csg.vol -o out.png
render scene *args:
    cargo run --release -- render {{scene}} {{args}}

# The pictures of the documentation
gallery:
    scripts/gallery

# Look for inputs that break the compiler: just fuzz parse --seconds 600
fuzz *args:
    scripts/fuzz {{args}}

# Benchmarks; arguments go to `cargo bench`
bench *args:
    cargo bench --workspace {{args}}

# Format all Rust code
fmt:
    cargo fmt --all
