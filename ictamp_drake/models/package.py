"""Where the model files lie."""

from pathlib import Path

from pydrake.multibody.parsing import Parser

PACKAGE_FILE = Path(__file__).parent / "package.xml"


def add_package(parser: Parser) -> None:
    """Make the files beside this module known as package://ictamp_drake/..."""
    parser.package_map().AddPackageXml(filename=PACKAGE_FILE)
