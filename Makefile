# `make` lists what there is to do.

.DEFAULT_GOAL := help
.NOTPARALLEL: # cargo keeps the cores busy by itself, and checks should end in the order in which they are named
.PHONY: help demo test bless verify-all bench docs clean setup format promises lints licences

# Mesa's device chooser asks for a desktop, and complains on standard error where there is none. The program sets this itself.
export NODEVICE_SELECT := 1

UMBRAE := cargo run --quiet --release --package umbrae --
STUDY := --lat 48.2 --lon 16.37 --date 2026-09-18 --from 09:00 --to 17:00
SCENES := town high-rise
SUNS := morning:105,28 noon:180,52 evening:262,18 # name:azimuth,altitude in degrees

help: ## list these targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: setup ## study the hours of sun in a town, and render two scenes under three suns each, to out/
	cargo build --release --package umbrae
	@mkdir -p out
	$(UMBRAE) sample town -o out/town.glb
	$(UMBRAE) study out/town.glb $(STUDY) -o out/town-study
	@set -e; for scene in $(SCENES); do \
		$(UMBRAE) sample $$scene -o out/$$scene.glb; \
		for sun in $(SUNS); do \
			echo "rendering out/$$scene-$${sun%:*}.png"; \
			$(UMBRAE) render out/$$scene.glb --sun $${sun#*:} -o out/$$scene-$${sun%:*}.png; \
		done; \
	done
	@printf '\nOpen this page, the study of a day in September in Vienna:\n  out/town-study/report.html\nand these pictures:\n'
	@for scene in $(SCENES); do for sun in $(SUNS); do echo "  out/$$scene-$${sun%:*}.png"; done; done

# The tests come last, so that a run ends with how many there were.
test: setup format promises lints docs licences ## check everything that CI checks
	cargo test --workspace --doc --no-fail-fast
	@if command -v cargo-nextest >/dev/null; then set -x; cargo nextest run --workspace; \
	else set -x; cargo test --workspace --tests --no-fail-fast; fi

bless: setup ## accept one golden picture as it is now: BLESS=name make bless
	@test -n "$(BLESS)" || { echo 'error: name the picture to bless: BLESS=name make bless' >&2; exit 2; }
	@test -z "$(CI)" || { echo 'error: CI does not bless pictures; bless where someone looks at them' >&2; exit 2; }
	BLESS='$(BLESS)' cargo test --workspace --test golden

verify-all: setup ## compare every pixel of every model, light and camera with rays, and print the table
	UMBRAE_VERIFY_SILHOUETTES=every cargo test --release --package umbrae --test verify -- --nocapture

bench: setup ## measure how fast it is; BENCHMARKS.md tells how to read the figures
	cargo bench --workspace
	scripts/bench-silhouettes.sh

docs: ## build the documentation of the crates, without a warning
	RUSTDOCFLAGS=-Dwarnings cargo doc --workspace --no-deps

clean: ## remove what was built and rendered
	cargo clean
	rm -rf out

setup: ## install what is missing besides Rust: a Vulkan driver, a C compiler
	@scripts/setup.sh

format:
	cargo fmt --all --check

promises:
	scripts/crate-promises.sh

# All targets: the benches and examples must compile as well.
lints:
	cargo clippy --workspace --all-targets -- -D warnings

licences:
	@if command -v cargo-deny >/dev/null; then set -x; \
		cargo deny --offline check --hide-inclusion-graph licenses bans sources; \
	else echo 'skipped: licences and sources of dependencies, because cargo-deny is not installed'; fi
