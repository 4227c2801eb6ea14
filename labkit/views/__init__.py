"""What a person looks at: cards, pictures, tables, forms."""
