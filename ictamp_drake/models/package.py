"""Location of the model files."""

from pathlib import Path

from pydrake.multibody.parsing import Parser

PACKAGE_FILE = Path(__file__).parent / "package.xml"


def add_package(parser: Parser) -> None:
    """Register the files beside this module as package://ictamp_drake/..."""
    parser.package_map().AddPackageXml(filename=PACKAGE_FILE)
