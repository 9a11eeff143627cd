"""Results turned into plain blocks; the PDF writer knows no surveying."""
