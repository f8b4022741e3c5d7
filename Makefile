# make run      set up, then simulate and record; SCENE=NAME chooses the scene
# make test     set up, then run the tests
# make stress   the long tests that look for instability
# make benchmark  run time against error, this engine and others
# make lint     the style checks alone
# make clean    remove what the others made
#
# PYTHON=python3.12 chooses the interpreter. If a ROS installation is sourced its rclpy is used,
# otherwise rclpy comes with the virtual environment.

PYTHON ?= python3
SCENE ?= ten_cubes
VENV := .venv

ROS := $(shell test -n "$$ROS_DISTRO" && $(PYTHON) -c 'import rclpy' 2>/dev/null && echo $$ROS_DISTRO)
VERSION := $(shell $(PYTHON) -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null)
SUPPORTED := 3.10 3.11 3.12 3.13

# Named after what it was made for: another interpreter or another ROS makes another.
READY := $(VENV)/ready_$(VERSION)_$(or $(ROS),wheels)

PIP_OPTIONS := --quiet --disable-pip-version-check --use-pep517

export PYTHONUNBUFFERED := 1

.PHONY: run test stress benchmark lint clean
.DELETE_ON_ERROR:

run: $(READY)
	@exec $(VENV)/bin/rigid_sim_node --ros-args -p 'scene:=$(SCENE)' -p record:=true

test: $(READY)
	$(VENV)/bin/python -m pytest

stress: $(READY)
	$(VENV)/bin/python -m pytest -m stress

lint: $(READY)
	$(VENV)/bin/python -m pytest test/test_flake8.py test/test_pep257.py test/test_copyright.py \
		test/test_xmllint.py test/test_architecture.py

benchmark: $(READY)_peers
	$(VENV)/bin/rigid_sim_benchmark

$(READY): setup.py setup.cfg pyproject.toml
	$(if $(VERSION),,$(error $(PYTHON) is not installed; give another: make PYTHON=python3.12))
	$(if $(filter $(VERSION),$(SUPPORTED)),,$(error $(PYTHON) is Python $(VERSION), one of \
		$(SUPPORTED) is needed; give another: make PYTHON=python3.12))
	$(if $(shell $(PYTHON) -c 'import ensurepip, venv; print(1)' 2>/dev/null),,$(error \
		$(PYTHON) has no venv; install it: sudo apt install python3-venv))
	@echo 'Setting up $(VENV), once, which takes one minute or some'
	@rm -rf $(VENV)
ifdef ROS
	@$(PYTHON) -m venv --system-site-packages $(VENV)
	@$(VENV)/bin/pip install $(PIP_OPTIONS) --editable '.[record,view,test]' \
		"numpy==$$($(PYTHON) -c 'import numpy; print(numpy.__version__)')"
else
	@$(PYTHON) -m venv $(VENV)
	@$(VENV)/bin/pip install $(PIP_OPTIONS) --editable '.[ros,record,view,test]'
endif
	@touch $@

$(READY)_peers: $(READY)
	@$(VENV)/bin/pip install $(PIP_OPTIONS) --editable '.[peers]'
	@touch $@

clean:
	rm -rf $(VENV) build *.egg-info .pytest_cache .hypothesis
